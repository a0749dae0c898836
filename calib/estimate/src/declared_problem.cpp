#include "rigproof/calib/estimate/declared_problem.h"

#include <algorithm>

namespace rigproof::ml {
namespace {

NoiseLevels to_levels(const CalibrationNoise& noise, std::size_t cameras) {
  NoiseLevels levels;
  levels.odometry_model = noise.odometry_model;
  levels.along_way = noise.along_way;
  levels.odometry_xy_m = std::max(noise.odometry_xy_m, kMinOdometryXy_m);
  levels.odometry_yaw_rad = std::max(noise.odometry_yaw_rad, kMinOdometryYaw_rad);
  levels.suspension_height_m = std::max(noise.suspension_height_m, kMinSuspensionHeight_m);
  levels.suspension_tilt_rad = std::max(noise.suspension_tilt_rad, kMinSuspensionTilt_rad);
  levels.corner_scale.assign(cameras, 1.0);
  levels.ground_scale.assign(cameras, 1.0);
  levels.board_plane_scale.assign(cameras, 1.0);
  return levels;
}

}  // namespace

Problem declared_problem(const Observations& observations, const CalibrationNoise& noise) {
  return Problem(observations, Priors::of({observations, noise.priors, false}),
                 to_levels(noise, observations.cameras.size()));
}

}  // namespace rigproof::ml
