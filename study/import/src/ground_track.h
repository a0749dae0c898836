// Poses in space as odometry on the ground.
#pragma once

#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct TimedPose {
  double stamp_s = 0.0;
  Rigid3 T_world_robot;
};

/// How far poses are from a drive on level ground.
struct GroundTrack {
  std::vector<OdometrySample> odometry;  ///< x, y and yaw
  double tilt_deg = 0.0;                 ///< largest angle between the robot's z and the world's
  double rise_m = 0.0;                   ///< highest less lowest position
};

/// @param poses by strictly increasing stamp
GroundTrack ground_track(const std::vector<TimedPose>& poses);

}  // namespace rigproof
