#include "ml/told_noise.h"

#include <algorithm>

#include "methods/depth_bias.h"

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

Problem told_problem(const Observations& observations, const CalibrationNoise& noise) {
  Priors priors;
  priors.odometry_scale = noise.odometry_scale_prior;
  priors.odometry_yaw_factor = noise.odometry_yaw_factor_prior;
  priors.focal_relative = noise.focal_relative_prior;
  priors.principal_point_px = noise.principal_point_prior_px;
  priors.clock_offset_s = noise.clock_offset_prior_s;
  priors.turn_lag_s = noise.turn_lag_prior_s;
  for (const RigCamera& camera : observations.cameras)
    priors.depth_bias.push_back(camera.depth ? camera.depth->noise.scale_sigma : 0.0);
  priors.ground_offset = ground_plane_biases(observations, DepthScaleSource::kBoard);
  return Problem(observations, priors, to_levels(noise, observations.cameras.size()));
}

}  // namespace rigproof::ml
