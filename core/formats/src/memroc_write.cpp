// Writes the layout of the MEMROC authors' program: cameraN/ by cameraN/; everything of a stop has the stop's number.
#include <fmt/core.h>

#include <array>

#include "memroc.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

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

// `number_of_rows` are the inner corners along the board's x axis, `size` in metres.
std::string calibration_info(const Rig& rig) {
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

std::string intrinsics(const Camera& camera) {
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

// T_world_robot, four rows of four numbers with commas.
std::string pose_text(const Rigid3& T_world_robot) {
  const Eigen::Matrix4d matrix = T_world_robot.matrix();
  std::string text;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) text += real(matrix(r, c)) + (c < 3 ? "," : "\n");
  return text;
}

// x y z, a point a line, metres in the colour camera's frame.
std::string cloud_text(const std::vector<Eigen::Vector3f>& points) {
  std::string text;
  text.reserve(points.size() * 36);
  for (const Eigen::Vector3f& p : points) {
    for (int i = 0; i < 3; ++i) text += short_text(static_cast<double>(p[i]), kCloudDigits) + (i < 2 ? " " : "\n");
  }
  return text;
}

std::string camera_folder(std::size_t camera) { return "camera" + std::to_string(camera + 1); }

std::string frame_name(std::size_t frame) { return fmt::format("{:04}", frame); }

void refuse_what_cannot_be_said(const Recording& recording) {
  Problems problems;
  const std::string file = (recording.folder / "rig.yaml").string();
  for (const RigCamera& camera : recording.rig.cameras)
    if (camera.camera.lens == Lens::kKannalaBrandt)
      problems.add({file, 0, "cameras." + camera.name + ".lens", lens_name(camera.camera.lens),
                    "the MEMROC layout only has pinhole and brown_conrady"});
  if (recording.rig.board.ambiguous_under_half_turn())
    problems.add({file, 0, "board", "",
                  "the board looks the same when turned by 180 degrees, so its first corner cannot be told"});
  problems.throw_if_any();
}

// A cloud that is text already stays as it is. Returns whether there is one.
bool write_cloud(const WriteJob& job, const RigCamera& camera, const CameraFrame& frame, const fs::path& file) {
  if (frame.cloud_file.empty() && (frame.depth_file.empty() || !camera.depth)) return false;
  if (!frame.cloud_file.empty() && fs::path(frame.cloud_file).extension() != ".pcd")
    copy_file_into(path_inside(job.recording.folder, frame.cloud_file), file);
  else
    write_file_atomically_unsynced(file, cloud_text(job.points_of(camera, frame)));
  return true;
}

// Returns whether it has a cloud.
bool write_frame(const WriteJob& job, std::size_t number, std::size_t k, const fs::path& folder) {
  const auto& [stop, frames] = job.stops[number];
  const CameraFrame& frame = job.recording.frames[k][static_cast<std::size_t>(frames[k])];
  const std::string name = frame_name(number);
  const fs::path image = path_inside(job.recording.folder, frame.color_file);
  copy_file_into(image, folder / "image" / (name + image.extension().string()));
  write_file_atomically_unsynced(folder / "pose" / (name + ".csv"),
                                 pose_text(planar_pose(stop.x_m, stop.y_m, stop.yaw_rad)));
  return write_cloud(job, job.recording.rig.cameras[k], frame, folder / "clouds" / (name + ".txt"));
}

void make_camera_folder(const RigCamera& camera, const fs::path& folder) {
  create_folder(folder / "image");
  create_folder(folder / "pose");
  if (camera.depth) create_folder(folder / "clouds");
  write_file_atomically_unsynced(folder / kMemrocIntrinsicsFile, intrinsics(camera.camera));
}

std::size_t image_total(const std::vector<StopFrames>& stops) {
  std::size_t count = 0;
  for (const StopFrames& stop : stops)
    for (const int frame : stop.frames) count += frame >= 0;
  return count;
}

std::vector<std::string> notes_on(const WriteJob& job) {
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < job.recording.rig.cameras.size(); ++k) {
    const std::string name = camera_folder(k);
    if (job.recording.rig.cameras[k].name != name)
      notes.push_back(job.recording.rig.cameras[k].name + " is " + name + " there.");
  }
  if (job.frames_without_stop > 0)
    notes.push_back(std::to_string(job.frames_without_stop) +
                    " images are left out: without odometry, or of a standstill that has others.");
  notes.emplace_back("Stamps, depth noise and names have no place in that layout.");
  return notes;
}

}  // namespace

ConvertReport write_memroc(const WriteJob& job) {
  refuse_what_cannot_be_said(job.recording);
  ConvertReport report;
  const std::size_t total = image_total(job.stops);
  write_file_atomically_unsynced(job.folder / kMemrocInfoFile, calibration_info(job.recording.rig));
  for (std::size_t k = 0; k < job.recording.rig.cameras.size(); ++k) {
    const fs::path folder = job.folder / camera_folder(k);
    make_camera_folder(job.recording.rig.cameras[k], folder);
    for (std::size_t i = 0; i < job.stops.size(); ++i) {
      if (job.stops[i].frames[k] < 0) continue;
      report.clouds += write_frame(job, i, k, folder);
      job.step(++report.images, total);
    }
  }
  report.notes = notes_on(job);
  return report;
}

}  // namespace rigproof
