#include "rigproof/validate/statistics.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rigproof {

Interval chi_square_interval(double degrees_of_freedom, double probability) {
  const double tail = 0.5 * (1.0 - probability);
  return {chi_square_quantile(tail, degrees_of_freedom), chi_square_quantile(1.0 - tail, degrees_of_freedom)};
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
