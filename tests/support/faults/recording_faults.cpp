#include "recording_faults.h"

#include <algorithm>
#include <stdexcept>

#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

std::vector<RecordingFault> all_faults() {
  std::vector<RecordingFault> all;
  for (const auto& part : {lens_faults(), board_faults(), depth_faults(), odometry_faults(), time_faults(),
                           picture_faults(), place_faults()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

RecordingFault both(const RecordingFault& first, const RecordingFault& second) {
  RecordingFault pair = first;
  pair.name = first.name + " and " + second.name;
  pair.part = "pair";
  pair.codes.insert(pair.codes.end(), second.codes.begin(), second.codes.end());
  pair.files.insert(second.files.begin(), second.files.end());
  pair.variants.insert(second.variants.begin(), second.variants.end());
  pair.apply = [first = first.apply, second = second.apply](FaultyRecording* recording) {
    first(recording);
    second(recording);
  };
  pair.fits = [first = first.fits, second = second.fits](const Rig& rig) {
    return (!first || first(rig)) && (!second || second(rig));
  };
  return pair;
}

}  // namespace

const std::vector<RecordingFault>& recording_faults() {
  static const std::vector<RecordingFault> all = all_faults();
  return all;
}

const RecordingFault& fault_named(const std::string& name) {
  const auto& all = recording_faults();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& fault) { return fault.name == name; });
  if (found == all.end()) throw std::logic_error("no fault is named " + name);
  return *found;
}

std::vector<RecordingFault> recording_fault_pairs() {
  struct Pair {
    const char *first, *second, *cannot_show = "";
  };
  const Pair names[] = {
      {"squares of the board +3 %", "depth of all cameras +50 mm"},
      {"squares of the board +3 %", "depth counts of all cameras +3 %",
       "board and depth agree on a world that is 3 % larger, and only the odometry's scale, known to 2 % at best, is "
       "left to contradict: a test that knows the truth sees 1.5 standard deviations "
       "(MlStrangers.ASizeThatBoardAndDepthShareIsKnownByTheOdometryAlone)"},
      {"squares of the board +3 %", "odometry's way +3 %"},
      {"squares of the board +1 %", "focal length of all cameras +1 %"},
      {"squares of the board -5 %", "focal length of all cameras -3 %"},
      {"squares of the board +10 %", "odometry in millimetres"},
      {"squares of the board +2 %", "frames of all cameras +200 ms"},
      {"focal length of one camera +1 %", "depth counts of one camera +1 %"},
      {"focal length of one camera +5 %", "odometry's turns +5 %"},
      {"focal length of all cameras -3 %", "depth counts of all cameras -3 %"},
      {"focal length of one camera +2 %", "principal point of one camera +3 px along y"},
      {"principal point of one camera +10 px along x", "gyro bias +0.2 deg/s"},
      {"principal points of all cameras +0.5 px", "depth of all cameras +20 mm"},
      {"distortion of one camera omitted", "squares of the board +2 %"},
      {"depth unit of all cameras x 10", "odometry in millimetres"},
      {"depth of one camera tilted by 1 deg", "depth of one camera +20 mm"},
      {"odometry's yaw in degrees", "odometry in millimetres"},
      {"odometry's yaw of the wrong sign", "frames of all cameras +1000 ms"},
      {"odometry's way +3 %", "odometry's turns +5 %"},
      {"odometry mirrored", "squares of the board -5 %"},
      {"gyro bias +0.2 deg/s", "frames of one camera +200 ms"},
      {"camera pitched by 1 deg at half time", "focal length of one camera +2 %"},
      {"board aside by 10 mm at half time", "odometry's turns +2 %"},
      {"images of one camera mirrored", "focal length of one camera +5 %"},
      {"images of two cameras swapped", "squares of the board +10 %"},
      {"JPEG of quality 15", "squares of the board +2 %"},
  };
  std::vector<RecordingFault> pairs;
  for (const Pair& pair : names) {
    pairs.push_back(both(fault_named(pair.first), fault_named(pair.second)));
    pairs.back().cannot_show = pair.cannot_show;
  }
  return pairs;
}

bool has_two_cameras(const Rig& rig) { return rig.cameras.size() > 1; }

bool has_two_depth_cameras(const Rig& rig) {
  return std::count_if(rig.cameras.begin(), rig.cameras.end(),
                       [](const RigCamera& camera) { return camera.depth.has_value(); }) > 1;
}

bool has_distortion(const RigCamera& camera) {
  return std::any_of(camera.camera.distortion.begin(), camera.camera.distortion.end(), [](double k) { return k != 0; });
}

std::string sized(const std::string& what, double size, const std::string& unit) {
  return what + (size > 0.0 ? " +" : " ") + number_text(size) + unit;
}

}  // namespace rigproof::faults
