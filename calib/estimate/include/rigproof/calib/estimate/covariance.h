// From the covariance of the unknowns to covariances of transforms.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/state.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Derivative of the cameras' errors (chart of transform_error(), six a camera) by the globals.
Eigen::MatrixXd camera_chart(const State& state, const Layout& layout);
/// Derivative of the error of X_j^-1 X_k by the errors of all cameras (six a camera, same chart).
Eigen::MatrixXd pair_chart(const std::vector<Rigid3>& T_robot_camera, int parent, int child);

/// Whether the odometry tells the motion of the point about which the robot turns: that of wheels that were integrated
/// along the way does, and any other if the rig states where the point lies.
bool is_of_turning_point(OdometryModel model, const Observations& observations);

/// Adds to the cameras' covariance (six a camera, same chart) the errors that no data determine and that move all
/// cameras alike: where along x and y the point lies about which the robot turns, if that is taken for the origin, and
/// how much higher the robot rides on its tyres while it moves.
void add_common_errors(const PriorSigmas& priors, bool turning_point_for_origin, Eigen::MatrixXd* joint);

}  // namespace rigproof::ml
