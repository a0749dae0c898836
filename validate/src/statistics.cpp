#include "rigproof/validate/statistics.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rigproof {

Interval chi_square_interval(double degrees_of_freedom, double probability) {
  const double tail = 0.5 * (1.0 - probability);
  return {chi_square_quantile(tail, degrees_of_freedom), chi_square_quantile(1.0 - tail, degrees_of_freedom)};
}

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

Eigen::Matrix<double, 6, 12> relative_error_jacobian(const Rigid3& T_r_j, const Rigid3& T_r_k) {
  const Eigen::Matrix3d R_transposed = T_r_j.rotation_matrix().transpose();
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  J.block<3, 3>(0, 0) = -R_transposed;
  J.block<3, 3>(0, 3) = R_transposed * skew(T_r_k.translation - T_r_j.translation);
  J.block<3, 3>(0, 6) = R_transposed;
  J.block<3, 3>(3, 3) = -R_transposed;
  J.block<3, 3>(3, 9) = R_transposed;
  return J;
}

std::optional<double> normalised_error_squared(const std::vector<Rigid3>& estimates, const std::vector<Rigid3>& truths,
                                               const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = static_cast<Eigen::Index>(estimates.size());
  if (covariance.rows() != 6 * n || covariance.cols() != 6 * n || !covariance.allFinite()) return std::nullopt;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  Eigen::VectorXd error(6 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t pose = static_cast<std::size_t>(i);
    J.block<6, 6>(6 * i, 6 * i) = left_perturbation_jacobian(estimates[pose]);
    error.segment<6>(6 * i) = se3_log(estimates[pose] * truths[pose].inverse());
  }
  const Eigen::MatrixXd left_covariance = J * covariance * J.transpose();
  // Metres and radians differ by orders of magnitude: factorise the correlation matrix, which is well scaled.
  const Eigen::VectorXd scale = left_covariance.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  const Eigen::VectorXd inverse_scale = scale.cwiseInverse();
  const Eigen::MatrixXd correlation = inverse_scale.asDiagonal() * left_covariance * inverse_scale.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd whitened = factor.matrixL().solve(inverse_scale.cwiseProduct(error));
  return whitened.squaredNorm();
}

}  // namespace rigproof
