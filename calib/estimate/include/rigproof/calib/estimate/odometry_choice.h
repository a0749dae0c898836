// Which of the two odometry noise models holds.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

struct OdometryChoice {
  Fit fit;
  std::optional<Fit> other;  ///< the next best model's solution, where it is not out of the question
  OdometryDecision decision;
  std::vector<Finding> notes;
};

/// The declared model's solution; where none is declared both are tried and the likelier is kept.
OdometryChoice choose_odometry(const Preparation& prepared);

}  // namespace rigproof::ml
