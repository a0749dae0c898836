// From the covariance of the unknowns to covariances of transforms.
#pragma once

#include <Eigen/Core>

#include "ml/state.h"

namespace rigproof::ml {

/// Derivative of the cameras' errors (chart of transform_error(), six a camera) by the globals.
Eigen::MatrixXd camera_chart(const State& state, const Layout& layout);
/// Derivative of the error of X_j^-1 X_k by the errors of all cameras (six a camera, same chart).
Eigen::MatrixXd pair_chart(const std::vector<Rigid3>& T_robot_camera, int parent, int child);

/// Adds what the cameras' covariance (six a camera, same chart) owes to the point about which the robot turns: where it
/// lies along x is known to sigma_m, and wheels that are integrated along the way take it for the origin. Odometry,
/// views and planes are the same wherever it lies, so that nothing but this prior tells, and all cameras move by as
/// much.
void add_rotation_centre(double sigma_m, Eigen::MatrixXd* joint);
/// Adds a common error of all cameras' heights, which nothing tells either: a robot that rides higher on its tyres
/// carries its cameras along, and depth measures them over the ground as they are then.
void add_riding_height(double sigma_m, Eigen::MatrixXd* joint);

}  // namespace rigproof::ml
