// The uncertainty that is stated of a solution, and by which it is refused.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "examination.h"
#include "rigproof/calib/estimate/budget.h"
#include "rigproof/calib/estimate/odometry_choice.h"

namespace rigproof::ml {

/// Of the cameras six values each, in the chart of transform_error().
struct Uncertainty {
  GlobalCovariance globals;         ///< of the global unknowns
  Eigen::MatrixXd joint;            ///< covariance of the cameras
  Eigen::MatrixXd gate_joint;       ///< the same, by which is refused
  std::vector<BudgetLine> budget;   ///< of what `joint` is made
  Eigen::MatrixXd free_directions;  ///< of the cameras that the data leave open, a column each with 1 as largest part
};

struct Statement {
  NoiseLevels levels;                      ///< by which the uncertainty is stated
  ArrowSystem system;                      ///< normal equations: the information that the loss keeps
  GroupSums sums;                          ///< of the residuals
  double cost = 0.0;                       ///< robust, whitened
  std::optional<Uncertainty> uncertainty;  ///< absent where the poses are not determined
};

Statement state_solution(const Preparation& prepared, const OdometryChoice& choice, const Examination& found);

}  // namespace rigproof::ml
