// Chi-square statistics and changes of chart of covariances.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/chi_square.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct Interval {
  double low = 0.0;
  double high = 0.0;
  bool contains(double value) const { return value >= low && value <= high; }
};
/// Central interval of chi-square that holds with the given probability.
Interval chi_square_interval(double degrees_of_freedom, double probability = 0.95);

/// Jacobian from an error in the chart of transform_error() (t_est - t, rotation vector) to the left perturbation
/// Log(X_est X^-1), at X: [[I, [t]x], [0, I]].
Matrix6d left_perturbation_jacobian(const Rigid3& T);
/// Jacobian from the error of T to the error of its inverse, both in the chart of transform_error().
Matrix6d inverse_error_jacobian(const Rigid3& T);
/// Jacobian from the errors of T_r_j and T_r_k, stacked, to the error of T_j_k = T_r_j^-1 T_r_k.
Eigen::Matrix<double, 6, 12> relative_error_jacobian(const Rigid3& T_r_j, const Rigid3& T_r_k);

/// Squared Mahalanobis norm of Log(X_est X^-1) of all poses together, with the covariance (6n x 6n, chart of
/// transform_error) carried over to the same left perturbation. Absent if the covariance is not positive definite.
std::optional<double> normalised_error_squared(const std::vector<Rigid3>& estimates, const std::vector<Rigid3>& truths,
                                               const Eigen::MatrixXd& covariance);

}  // namespace rigproof
