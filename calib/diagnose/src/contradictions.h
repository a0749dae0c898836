// Data that contradict each other: found in the residuals and the nuisances of a solution, with the likely cause.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// Contradictions, and the parts of the answer that they make unusable.
struct Contradictions {
  std::vector<Finding> odometry;  ///< x, y and yaw in the robot cannot be trusted
  std::vector<Finding> cameras;   ///< nothing can be trusted
  std::vector<bool> bad_corners;  ///< cameras whose corners are far off
};

/// @param sums of the solution, with leverage
Contradictions find_contradictions(const Problem& problem, const State& state, const GroupSums& sums);

}  // namespace rigproof::ml
