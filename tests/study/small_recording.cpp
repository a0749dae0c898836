#include "small_recording.h"

#include <opencv2/imgcodecs.hpp>

#include "rigproof/core/files.h"

namespace rigproof {
namespace {

constexpr int kWidth = 64, kHeight = 48;

// A floor that no two frames see alike.
void write_depth(const std::filesystem::path& file, int frame) {
  cv::Mat depth(kHeight, kWidth, CV_16U);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(v < 10 ? 0 : 1000 + 3 * u + 7 * v + 11 * frame);
  std::filesystem::create_directories(file.parent_path());
  cv::imwrite(file.string(), depth);
}

}  // namespace

Recording small_recording(const std::filesystem::path& folder) {
  Recording recording;
  recording.folder = folder;
  recording.rig.robot_frame = "base_link";
  RigCamera left, right;
  left.name = left.folder = left.link = "left";
  left.camera = Camera::symmetric(kWidth, kHeight, 40.0);
  left.camera.cx_px = 31.123456789;
  left.depth = DepthStream();
  right.name = right.folder = right.link = "right";
  right.camera = Camera::symmetric(kWidth, kHeight, 41.5);
  right.camera.lens = Lens::kBrownConrady;
  right.camera.distortion = {0.11, -0.24, 0.0004, -0.0003, 0.1};
  recording.rig.cameras = {left, right};
  recording.frames.resize(2);
  for (int i = 0; i < 3; ++i) {
    const std::string name = "00000" + std::to_string(i) + ".png";
    const double stamp_s = 100.0 + 2.0 * i;
    recording.odometry.push_back({stamp_s, 0.1 * i + 1.0 / 3.0, -0.2 * i * i, 0.3 * i - 0.1});
    recording.frames[0].push_back({"left/color/" + name, "left/depth/" + name, "", stamp_s, 0.005, 0});
    recording.frames[1].push_back({"right/color/" + name, "", "", stamp_s, 0.005, 0});
    for (const char* camera : {"left", "right"})
      write_file_atomically_unsynced(folder / camera / "color" / name, camera + (" image " + std::to_string(i)));
    write_depth(folder / "left/depth" / name, i);
  }
  save_recording(recording);
  return load_recording(folder);
}

}  // namespace rigproof
