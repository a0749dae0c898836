// Drives past a board without images: random rigs, exact or noisy corners, board poses, planes and odometry.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

enum class DriveKind { kRandom, kStraight, kInPlace, kArc, kStandstill };

struct DriveOptions {
  std::uint64_t seed = 0;
  DriveKind kind = DriveKind::kRandom;
  int cameras = 3;
  int stops = 20;
  bool any_mounting = false;  ///< any orientation of the camera and the board, instead of a forward rig
  bool overlap = true;        ///< all cameras look the same way; else each looks another way and sees its own stops
  double corner_sigma_px = 0.0;
  double odometry_sigma_m = 0.0;  ///< of each increment
  double odometry_sigma_rad = 0.0;
  bool ground = true;
  double plane_sigma_per_m = 1e-4;  ///< of each component of a plane; 0 = exact
};

/// A random rig of 1 to `most_cameras` cameras in any orientation; every third has no overlap.
DriveOptions any_mounting(std::uint64_t seed, int most_cameras);

struct SyntheticDrive {
  Observations observations;
  std::vector<Rigid3> T_robot_camera;
  Rigid3 T_world_board;
  std::vector<Rigid3> T_world_robot;
  /// Poses as PnP finds them, to first order in the corner noise.
  std::vector<ViewPose> views;
};

/// Every stop is seen by at least one camera. Draws another rig when the drive keeps the board out of view.
SyntheticDrive make_drive(const DriveOptions& options);

}  // namespace rigproof
