// Derivatives of errors of transforms in the chart of transform_error(): (t_est - t, rotation vector).
#pragma once

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// To the left perturbation Log(X_est X^-1), at X: [[I, [t]x], [0, I]].
Matrix6d left_perturbation_jacobian(const Rigid3& T);
/// From the error of T to the error of its inverse.
Matrix6d inverse_error_jacobian(const Rigid3& T);

/// From the errors of two transforms, stacked, to that of one made of both.
using RelativeJacobian = Eigen::Matrix<double, 6, 12>;
/// T_j_k = T_r_j^-1 T_r_k.
RelativeJacobian relative_error_jacobian(const Rigid3& T_r_j, const Rigid3& T_r_k);
/// T_j_k = T_j_r T_k_r^-1.
RelativeJacobian relative_error_jacobian_of_inverses(const Rigid3& T_j_r, const Rigid3& T_k_r);

}  // namespace rigproof
