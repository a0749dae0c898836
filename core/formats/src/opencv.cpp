// Writes what a program of OpenCV's needs for calibrateHandEye and its kin: one file of FileStorage beside the images.
#include <fmt/core.h>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// The tag and the four keys by which FileStorage knows a matrix.
std::string matrix_text(const std::string& name, std::size_t rows, std::size_t columns,
                        const std::vector<double>& values) {
  std::string text = name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
                     "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [";
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string number = number_text(values[i] + 0.0);
    const bool real = number.find_first_of(".e") != std::string::npos;
    text += std::string(i == 0 ? "" : i % columns == 0 ? ",\n       " : ", ") + number + (real ? "" : ".");
  }
  return text + "]\n";
}

// T_world_robot, a stop a line.
std::string poses_text(const std::vector<StopFrames>& stops) {
  std::vector<double> values;
  for (const StopFrames& at : stops) {
    const Eigen::Matrix4d T = planar_pose(at.stop.x_m, at.stop.y_m, at.stop.yaw_rad).matrix();
    for (Eigen::Index i = 0; i < 16; ++i) values.push_back(T(i / 4, i % 4));
  }
  return matrix_text("T_world_robot", stops.size(), 16, values);
}

std::string camera_text(const RigCamera& camera, const std::string& key, const std::vector<std::string>& images) {
  const Camera& lens = camera.camera;
  const bool fisheye = lens.lens == Lens::kKannalaBrandt;
  std::string text = key + "_name: \"" + camera.name + "\"\n" + key + "_lens: \"" + lens_name(lens.lens) + "\"\n" +
                     key + "_size: [" + std::to_string(lens.width_px) + ", " + std::to_string(lens.height_px) + "]\n";
  text += matrix_text(key + "_K", 3, 3, {lens.fx_px, 0.0, lens.cx_px, 0.0, lens.fy_px, lens.cy_px, 0.0, 0.0, 1.0});
  const std::size_t count = fisheye ? 4 : 5;
  text += matrix_text(key + "_D", 1, count, {lens.distortion.begin(), lens.distortion.begin() + count});
  text += key + "_images:\n";
  for (const std::string& image : images) text += "   - \"" + image + "\"\n";
  return text;
}

// One name a stop, empty where the camera has no image.
std::vector<std::string> copy_images(const WriteJob& job, std::size_t k, const std::string& folder, std::size_t total,
                                     std::size_t* done) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < job.stops.size(); ++i) {
    names.emplace_back();
    const int frame = job.stops[i].frames[k];
    if (frame < 0) continue;
    const fs::path image =
        path_inside(job.recording.folder, job.recording.frames[k][static_cast<std::size_t>(frame)].color_file);
    names.back() = folder + "/" + fmt::format("{:04}", i) + image.extension().string();
    copy_file_into(image, job.folder / names.back());
    job.step(++*done, total);
  }
  return names;
}

ConvertReport write_opencv(const WriteJob& job) {
  const Rig& rig = job.recording.rig;
  ConvertReport report;
  std::size_t total = 0;
  for (const StopFrames& stop : job.stops)
    for (const int frame : stop.frames) total += frame >= 0;
  std::string text = "%YAML:1.0\n---\nboard_type: \"" + rig.board.type + "\"\nboard_corners: [" +
                     std::to_string(rig.board.inner_corners_x()) + ", " + std::to_string(rig.board.inner_corners_y()) +
                     "]\nboard_square_m: " + number_text(rig.board.square_m) + "\n" + poses_text(job.stops) +
                     "cameras: " + std::to_string(rig.cameras.size()) + "\n";
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    const std::string key = "camera" + std::to_string(k);
    text += camera_text(rig.cameras[k], key, copy_images(job, k, key, total, &report.images));
  }
  write_file_atomically_unsynced(job.folder / "recording.yml", text);
  report.notes.emplace_back("Depth and stamps have no place in that layout; a line of T_world_robot is a stop.");
  return report;
}

}  // namespace

Format opencv_format() {
  Format format;
  format.name = "opencv";
  format.what = "OpenCV's FileStorage";
  format.write = write_opencv;
  format.wants_stops = true;
  return format;
}

}  // namespace rigproof
