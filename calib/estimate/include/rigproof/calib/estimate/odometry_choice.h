// Which odometry noise model holds.
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

/// The law of a model that is declared.
OdometryLaw declared_law(OdometryModel model, const MlOptions& options);

/// The declared model's solution; where none is declared all are tried and the likeliest is kept.
OdometryChoice choose_odometry(const Preparation& prepared);

}  // namespace rigproof::ml
