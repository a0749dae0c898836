// The problem whose noise is declared, not estimated.
#pragma once

#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/problem.h"

namespace rigproof::ml {

/// Observations with the given levels and priors; corners and planes carry their covariances.
/// The observations must outlive the problem.
Problem declared_problem(const Observations& observations, const CalibrationNoise& noise);

}  // namespace rigproof::ml
