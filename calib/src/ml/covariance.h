// From the covariance of the unknowns to covariances of transforms.
#pragma once

#include <Eigen/Core>

#include "ml/state.h"

namespace rigproof::ml {

/// Derivative of the cameras' errors (chart of transform_error(), six a camera) by the globals.
Eigen::MatrixXd camera_chart(const State& state, const Layout& layout);
/// Derivative of the error of X_j^-1 X_k by the errors of all cameras (six a camera, same chart).
Eigen::MatrixXd pair_chart(const std::vector<Rigid3>& T_robot_camera, int parent, int child);

}  // namespace rigproof::ml
