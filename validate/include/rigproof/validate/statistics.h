// Chi-square statistics.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/chi_square.h"
#include "rigproof/core/error_jacobians.h"

namespace rigproof {

struct Interval {
  double low = 0.0;
  double high = 0.0;
  bool contains(double value) const { return value >= low && value <= high; }
};
/// Central interval of chi-square that holds with the given probability.
Interval chi_square_interval(double degrees_of_freedom, double probability = 0.95);

/// Squared Mahalanobis norm of Log(X_est X^-1) of all poses together, with the covariance (6n x 6n, chart of
/// transform_error) carried over to the same left perturbation. Absent if the covariance is not positive definite.
std::optional<double> normalised_error_squared(const std::vector<Rigid3>& estimates, const std::vector<Rigid3>& truths,
                                               const Eigen::MatrixXd& covariance);

}  // namespace rigproof
