// The uncertainty budget: what each variance of the cameras is made of.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rigproof/calib/estimate/problem.h"

namespace rigproof::ml {

/// The variances of the cameras (six a camera, chart of transform_error()) that one source of information leaves.
struct BudgetLine {
  std::string source;  ///< "corners", "odometry", "lens", ..
  Eigen::VectorXd variances;
};

/// With H = sum H_k over residuals and priors and C = H^-1, the estimate is linear in what was measured and believed,
/// and C = sum C H_k C: line k is the diagonal of C H_k C, exact but for the linearisation.
/// @param system the normal equations of the problem at the state, by Weighting::kInformation
/// @param globals the covariance of the global unknowns
/// Empty where the robot poses are not determined.
std::vector<BudgetLine> budget_of(const Problem& problem, const State& state, const ArrowSystem& system,
                                  const Eigen::MatrixXd& globals);

/// Adds to the line of that source, or a new line.
void add_to_budget(const std::string& source, const Eigen::VectorXd& variances, std::vector<BudgetLine>* budget);

}  // namespace rigproof::ml
