// Cameras, or the board, that were moved during the drive: score tests at every split of the stops, confirmed by a
// solution in which what moved has a second pose.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// Steps are looked for at so many splits at first, in drives of so many stops at least.
inline constexpr int kSplitsAtFirst = 16;
inline constexpr int kLeastStopsForSteps = 2 * kLeastViewsOfStep;

struct FoundStep {
  Fit fit;  ///< with the second poses
  double deviations = 0.0;
  double gain = 0.0;              ///< by how much -2 ln of the likelihood falls with it
  std::vector<Finding> findings;  ///< one, or more where the data do not tell them apart (`joined_by`)
  bool bends = false;             ///< what would be stated without it is wrong by more than its uncertainty allows
};

/// @param fit a solution @param scores of steps there
std::optional<FoundStep> find_step(const Preparation& prepared, const Fit& fit, const std::vector<StepScore>& scores);

}  // namespace rigproof::ml
