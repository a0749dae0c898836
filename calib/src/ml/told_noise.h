// The problem whose noise is told, not estimated.
#pragma once

#include "ml/problem.h"
#include "rigproof/calib/information.h"

namespace rigproof::ml {

/// Observations with the given levels and priors; corners and planes carry their covariances.
/// The observations must outlive the problem.
Problem told_problem(const Observations& observations, const CalibrationNoise& noise);

}  // namespace rigproof::ml
