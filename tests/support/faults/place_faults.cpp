#include "recording_faults.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

// From half time on the images of a camera, or of all, are those of the changed drive.
void replace_second_half(FaultyRecording* r, std::size_t camera, const std::string& variant) {
  const std::vector<CameraFrame>& frames = r->now().frames[camera];
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
    r->replace_by_variant(frames[i].color_file, variant);
    if (!frames[i].depth_file.empty()) r->replace_by_variant(frames[i].depth_file, variant);
  }
}

using Codes = std::vector<std::string>;

// In the plane of the floor a board that was moved is what slipping wheels are.
const Codes kCamera = {"camera.moved", "camera.moved_slightly"};
const Codes kBoard = {"board.moved", "board.moved_slightly", "odometry.slip"};

RecordingFault camera_moved(const std::string& name, const std::string& variant) {
  // The frames of a camera without depth are its images alone.
  const auto apply = [variant](FaultyRecording* r) { replace_second_half(r, r->depth_camera(), variant); };
  return {"camera " + name + " at half time", "place", kCamera, {Files::kColor, Files::kDepth}, apply, {}, {variant}};
}

RecordingFault all_moved(const std::string& name, const Codes& codes, const std::string& variant) {
  const auto apply = [variant](FaultyRecording* r) {
    for (std::size_t k = 0; k < r->cameras(); ++k) replace_second_half(r, k, variant);
  };
  return {name + " at half time", "place", codes, {Files::kColor, Files::kDepth}, apply, {}, {variant}};
}

}  // namespace

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all = {
      {"pitch-0.2", 0.2},
      {"pitch-0.5", 0.5},
      {"pitch-1", 1.0},
      {"pitch-3", 3.0},
      {"yaw-1", 0.0, 1.0},
      {"forward-5", 0.0, 0.0, 0.005},
      {"forward-20", 0.0, 0.0, 0.02},
      {"forward-100", 0.0, 0.0, 0.1},
      {"turn-0.5", 0.0, 0.0, 0.0, 0.5},
      {"turn-2", 0.0, 0.0, 0.0, 2.0},
      {"turn-10", 0.0, 0.0, 0.0, 10.0},
      {"aside-2", 0.0, 0.0, 0.0, 0.0, 0.002},
      {"aside-10", 0.0, 0.0, 0.0, 0.0, 0.01},
      {"aside-100", 0.0, 0.0, 0.0, 0.0, 0.1},
      {"wide-0.5", 0.0, 0.0, 0.0, 0.0, 0.0, 1.005},
      {"wide-2", 0.0, 0.0, 0.0, 0.0, 0.0, 1.02},
      {"bow-1", 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0},
      {"bow-6", 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 6.0},
  };
  return all;
}

std::vector<RecordingFault> place_faults() {
  std::vector<RecordingFault> faults;
  for (const char* deg : {"0.2", "0.5", "1", "3"})
    faults.push_back(camera_moved(std::string("pitched by ") + deg + " deg", std::string("pitch-") + deg));
  faults.push_back(camera_moved("turned by 1 deg", "yaw-1"));
  for (const char* mm : {"5", "20", "100"})
    faults.push_back(camera_moved(std::string("forward by ") + mm + " mm", std::string("forward-") + mm));
  faults.push_back(all_moved("all cameras pitched by 1 deg", kCamera, "pitch-1"));
  faults.push_back(all_moved("all cameras turned by 1 deg", kCamera, "yaw-1"));
  for (const char* deg : {"0.5", "2", "10"})
    faults.push_back(all_moved(std::string("board turned by ") + deg + " deg", kBoard, std::string("turn-") + deg));
  for (const char* mm : {"2", "10", "100"})
    faults.push_back(all_moved(std::string("board aside by ") + mm + " mm", kBoard, std::string("aside-") + mm));
  return faults;
}

}  // namespace rigproof::faults
