// The truth of a simulated run as the values at which calib evaluates information.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/core/error_jacobians.h"
#include "rigproof/core/result.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

inline CalibrationState state_of(const Truth& truth) {
  CalibrationState state;
  for (const TrueCamera& camera : truth.cameras) {
    state.T_robot_camera.push_back(camera.T_robot_camera);
    state.depth_scale.push_back(camera.depth_scale.value_or(1.0));
  }
  state.T_world_board = truth.T_world_board;
  for (const TrueBoard& board : truth.more_boards) state.T_world_more_boards.push_back(board.T_world_board);
  for (const TrueStop& stop : truth.stops) state.T_world_robot.push_back(stop.T_world_robot);
  state.odometry_scale = truth.odometry_scale;
  state.odometry_yaw_factor = truth.odometry_yaw_factor;
  return state;
}

/// The suspension is no part of the truth's noise: its standard deviations are the caller's.
inline CalibrationNoise noise_of(const Truth& truth, double suspension_height_m = 0.0,
                                 double suspension_tilt_rad = 0.0) {
  CalibrationNoise noise;
  noise.law.model = truth.odometry_noise.model;
  noise.odometry_xy_m = truth.odometry_noise.sigma_xy_m.value_or(0.0);
  noise.odometry_yaw_rad = truth.odometry_noise.sigma_yaw_rad.value_or(0.0);
  noise.suspension_height_m = suspension_height_m;
  noise.suspension_tilt_rad = suspension_tilt_rad;
  return noise;
}

inline std::vector<Rigid3> poses_of(const Truth& truth) {
  std::vector<Rigid3> T_robot_camera;
  for (const TrueCamera& camera : truth.cameras) T_robot_camera.push_back(camera.T_robot_camera);
  return T_robot_camera;
}

/// Joint covariance of the cameras in the chart of Log(X_hat X^-1), from that in the chart of transform_error().
inline Eigen::MatrixXd to_left_perturbation(const Eigen::MatrixXd& joint, const std::vector<Rigid3>& T_robot_camera) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(joint.rows(), joint.cols());
  for (std::size_t c = 0; c < T_robot_camera.size(); ++c) {
    const Eigen::Index i = 6 * static_cast<Eigen::Index>(c);
    M.block<6, 6>(i, i) = left_perturbation_jacobian(T_robot_camera[c]);
  }
  return M * joint * M.transpose();
}

/// NEES of all cameras together, six degrees of freedom each. The result must have a joint covariance.
inline double nees(const Result& result, const std::vector<Rigid3>& estimate, const std::vector<Rigid3>& truth) {
  Eigen::VectorXd error(6 * static_cast<Eigen::Index>(estimate.size()));
  for (std::size_t c = 0; c < estimate.size(); ++c)
    error.segment<6>(6 * static_cast<Eigen::Index>(c)) = se3_log(estimate[c] * truth[c].inverse());
  return error.dot(to_left_perturbation(result.joint_covariance.value(), estimate).ldlt().solve(error));
}
inline double nees(const MlEstimate& estimate, const std::vector<Rigid3>& truth) {
  return nees(estimate.result, estimate.state.T_robot_camera, truth);
}

}  // namespace rigproof
