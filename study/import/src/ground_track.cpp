#include "ground_track.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof {

GroundTrack ground_track(const std::vector<TimedPose>& poses) {
  GroundTrack track;
  if (poses.empty()) return track;
  double lowest = poses.front().T_world_robot.translation.z(), highest = lowest;
  for (const TimedPose& pose : poses) {
    const Rigid3& T = pose.T_world_robot;
    track.odometry.push_back({pose.stamp_s, T.translation.x(), T.translation.y(), yaw_of(T)});
    const double up = (T.rotation * Eigen::Vector3d::UnitZ()).z();
    track.tilt_deg = std::max(track.tilt_deg, std::acos(std::clamp(up, -1.0, 1.0)) * 180.0 / kPi);
    lowest = std::min(lowest, T.translation.z());
    highest = std::max(highest, T.translation.z());
  }
  track.rise_m = highest - lowest;
  return track;
}

}  // namespace rigproof
