#include "rigproof/core/error_jacobians.h"

namespace rigproof {

Matrix6d left_perturbation_jacobian(const Rigid3& T) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = skew(T.translation);
  return J;
}

Matrix6d inverse_error_jacobian(const Rigid3& T) {
  const Eigen::Matrix3d R_transposed = T.rotation_matrix().transpose();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = -R_transposed;
  J.topRightCorner<3, 3>() = -R_transposed * skew(T.translation);
  J.bottomRightCorner<3, 3>() = -R_transposed;
  return J;
}

RelativeJacobian relative_error_jacobian(const Rigid3& T_r_j, const Rigid3& T_r_k) {
  const Eigen::Matrix3d R_transposed = T_r_j.rotation_matrix().transpose();
  RelativeJacobian J = RelativeJacobian::Zero();
  J.block<3, 3>(0, 0) = -R_transposed;
  J.block<3, 3>(0, 3) = R_transposed * skew(T_r_k.translation - T_r_j.translation);
  J.block<3, 3>(0, 6) = R_transposed;
  J.block<3, 3>(3, 3) = -R_transposed;
  J.block<3, 3>(3, 9) = R_transposed;
  return J;
}

RelativeJacobian relative_error_jacobian_of_inverses(const Rigid3& T_j_r, const Rigid3& T_k_r) {
  const Eigen::Matrix3d R = (T_j_r * T_k_r.inverse()).rotation_matrix(), lever = skew(R * T_k_r.translation);
  RelativeJacobian J = RelativeJacobian::Zero();
  J.leftCols<6>().setIdentity();
  J.block<3, 3>(0, 3) = lever;
  J.block<3, 3>(0, 6) = -R;
  J.block<3, 3>(0, 9) = -lever * R;
  J.block<3, 3>(3, 9) = -R;
  return J;
}

}  // namespace rigproof
