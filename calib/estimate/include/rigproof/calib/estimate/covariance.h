// From the covariance of the unknowns to covariances of transforms.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/state.h"

namespace rigproof::ml {

/// Derivative of the cameras' errors (chart of transform_error(), six a camera) by the globals.
Eigen::MatrixXd camera_chart(const State& state, const Layout& layout);
/// Derivative of the error of X_j^-1 X_k by the errors of all cameras (six a camera, same chart).
Eigen::MatrixXd pair_chart(const std::vector<Rigid3>& T_robot_camera, int parent, int child);

/// Adds to the cameras' covariance (six a camera, same chart) the errors that no data determine and that move all
/// cameras alike: the position along x of the point about which the robot turns (odometry along the way takes that
/// point for the origin), and how much higher the robot rides on its tyres while it moves.
void add_common_errors(const PriorSigmas& priors, bool along_way, Eigen::MatrixXd* joint);

}  // namespace rigproof::ml
