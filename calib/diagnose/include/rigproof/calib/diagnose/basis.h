// What the uncertainty of an answer is computed from.
#pragma once

#include <optional>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

struct Basis {
  Observations used;  ///< without the views and planes that were left out
  InitialGuess guess;
  State state;
  Priors priors;
  NoiseLevels levels;  ///< by which the uncertainty is stated
  ArrowSystem system;  ///< normal equations at the state: the information that the loss keeps
};

/// estimate_maximum_likelihood(), and what stands behind it. @param basis empty where there was nothing to solve
MlEstimate estimate_with_basis(const Observations& observations, const MlOptions& options, std::optional<Basis>* basis);

}  // namespace rigproof::ml
