#include "rigproof/formats/memroc_writer.h"

#include <array>
#include <cstdio>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// A float needs nine digits to come back exactly.
constexpr int kCloudDigits = 9;

void add_line(const std::string& key, const std::string& value, std::string* text) {
  *text += key + ": " + value + "\n";
}

// A reader that expects a real number gets one; zero has no sign.
std::string real(double value) {
  const std::string text = number_text(value == 0.0 ? 0.0 : value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

}  // namespace

std::string memroc_calibration_info(const Rig& rig) {
  std::string text;
  add_line("number_of_cameras", std::to_string(rig.cameras.size()), &text);
  add_line("camera_folder_prefix", "camera", &text);
  add_line("pattern_type", "checkerboard", &text);
  add_line("number_of_rows", std::to_string(rig.board.inner_corners_x()), &text);
  add_line("number_of_columns", std::to_string(rig.board.inner_corners_y()), &text);
  add_line("size", real(rig.board.square_m), &text);
  add_line("resize_factor", "1", &text);
  return text;
}

std::string memroc_intrinsics(const Camera& camera) {
  if (camera.lens == Lens::kKannalaBrandt)
    throw Error("the MEMROC layout has no fisheye lens (kannala_brandt); only pinhole and brown_conrady");
  std::string text;
  add_line("fx", real(camera.fx_px), &text);
  add_line("fy", real(camera.fy_px), &text);
  add_line("cx", real(camera.cx_px), &text);
  add_line("cy", real(camera.cy_px), &text);
  add_line("has_dist_coeff", "1", &text);
  // OpenCV's order k1 k2 p1 p2 k3 and the rational model's k4 k5 k6.
  const std::array<const char*, 5> names = {"dist_k0", "dist_k1", "dist_px", "dist_py", "dist_k2"};
  const bool distorted = camera.lens == Lens::kBrownConrady;
  for (std::size_t i = 0; i < names.size(); ++i)
    add_line(names[i], real(distorted ? camera.distortion[i] : 0.0), &text);
  for (const char* rational : {"dist_k3", "dist_k4", "dist_k5"}) add_line(rational, "0.0", &text);
  add_line("img_width", std::to_string(camera.width_px), &text);
  add_line("img_height", std::to_string(camera.height_px), &text);
  return text;
}

std::string memroc_pose(const Rigid3& T_world_robot) {
  const Eigen::Matrix4d matrix = T_world_robot.matrix();
  std::string text;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) text += real(matrix(r, c)) + (c < 3 ? "," : "\n");
  return text;
}

std::string memroc_cloud(const std::vector<Eigen::Vector3f>& points) {
  std::string text;
  text.reserve(points.size() * 36);
  for (const Eigen::Vector3f& p : points) {
    for (int i = 0; i < 3; ++i) text += short_text(static_cast<double>(p[i]), kCloudDigits) + (i < 2 ? " " : "\n");
  }
  return text;
}

std::string memroc_camera_folder(std::size_t camera) { return "camera" + std::to_string(camera + 1); }

std::string memroc_frame_name(std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "%04zu", frame);
  return name;
}

}  // namespace rigproof
