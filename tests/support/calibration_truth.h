// The truth of a simulated run as the values at which calib evaluates information.
#pragma once

#include "rigproof/calib/information.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

inline CalibrationState state_of(const Truth& truth) {
  CalibrationState state;
  for (const TrueCamera& camera : truth.cameras) {
    state.T_robot_camera.push_back(camera.T_robot_camera);
    state.depth_scale.push_back(camera.depth_scale.value_or(1.0));
  }
  state.T_world_board = truth.T_world_board;
  for (const TrueStop& stop : truth.stops) state.T_world_robot.push_back(stop.T_world_robot);
  state.odometry_scale = truth.odometry_scale;
  state.odometry_yaw_factor = truth.odometry_yaw_factor;
  return state;
}

/// The suspension is no part of the truth's noise: its standard deviations are the caller's.
inline CalibrationNoise noise_of(const Truth& truth, double suspension_height_m = 0.0,
                                 double suspension_tilt_rad = 0.0) {
  CalibrationNoise noise;
  noise.odometry_model = truth.odometry_noise.model;
  noise.odometry_xy_m = truth.odometry_noise.sigma_xy_m.value_or(0.0);
  noise.odometry_yaw_rad = truth.odometry_noise.sigma_yaw_rad.value_or(0.0);
  noise.suspension_height_m = suspension_height_m;
  noise.suspension_tilt_rad = suspension_tilt_rad;
  return noise;
}

}  // namespace rigproof
