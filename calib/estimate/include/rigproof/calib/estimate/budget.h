// The uncertainty budget: what each variance of the cameras is made of.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_covariance.h"

namespace rigproof::ml {

/// The variances of the cameras (six a camera, chart of transform_error()) that one source of information leaves.
struct BudgetLine {
  std::string source;  ///< "corners", "odometry", "lens", ..
  Eigen::VectorXd variances;
};

/// With H = sum H_k over residuals and priors and C = H^-1, the estimate is linear in what was measured and believed,
/// and C = sum C H_k C: line k is the diagonal of C H_k C, exact but for the linearisation. Errors that repeat in every
/// image are among the unknowns; their priors are one line.
std::vector<BudgetLine> budget_of(const Problem& problem, const State& state, const SolvedEquations& solved);

/// Adds to the line of that source, or a new line.
void add_to_budget(const std::string& source, const Eigen::VectorXd& variances, std::vector<BudgetLine>* budget);

}  // namespace rigproof::ml
