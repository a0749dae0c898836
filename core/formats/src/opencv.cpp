// Writes what a program of OpenCV's needs for calibrateHandEye and its kin: one file of FileStorage beside the images.
#include "opencv_text.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/format.h"
#include "stop_images.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// T_world_robot, a stop a line.
std::string poses_text(const std::vector<StopFrames>& stops) {
  std::vector<double> values;
  for (const StopFrames& at : stops) {
    const Eigen::Matrix4d T = planar_pose(at.stop.x_m, at.stop.y_m, at.stop.yaw_rad).matrix();
    for (Eigen::Index i = 0; i < 16; ++i) values.push_back(T(i / 4, i % 4));
  }
  return opencv_matrix("T_world_robot", stops.size(), 16, values);
}

std::string camera_text(const RigCamera& camera, const std::string& key, const std::vector<std::string>& images) {
  const Camera& lens = camera.camera;
  std::string text = key + "_name: \"" + camera.name + "\"\n" + key + "_lens: \"" + lens_name(lens.lens) + "\"\n" +
                     key + "_size: [" + std::to_string(lens.width_px) + ", " + std::to_string(lens.height_px) + "]\n";
  text += opencv_lens(lens, key + "_K", key + "_D");
  text += key + "_images:\n";
  for (const std::string& image : images) text += "   - \"" + image + "\"\n";
  return text;
}

ConvertReport write_opencv(const WriteJob& job) {
  const Rig& rig = job.recording.rig;
  ConvertReport report;
  std::string text = "%YAML:1.0\n---\nboard_type: \"" + rig.board.type + "\"\nboard_corners: [" +
                     std::to_string(rig.board.inner_corners_x()) + ", " + std::to_string(rig.board.inner_corners_y()) +
                     "]\nboard_square_m: " + number_text(rig.board.square_m) + "\n" + poses_text(job.stops) +
                     "cameras: " + std::to_string(rig.cameras.size()) + "\n";
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    const std::string key = "camera" + std::to_string(k);
    text += camera_text(rig.cameras[k], key, copy_stop_images(job, k, key, &report.images));
  }
  write_file_atomically_unsynced(job.folder / "recording.yml", text);
  report.notes.emplace_back("Depth and stamps have no place in that layout; a line of T_world_robot is a stop.");
  return report;
}

}  // namespace

Format opencv_format() {
  Format format;
  format.name = "opencv";
  format.equal_squares = true;
  format.what = "OpenCV's FileStorage";
  format.write = write_opencv;
  format.wants_stops = true;
  return format;
}

}  // namespace rigproof
