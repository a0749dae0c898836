// Estimates of lenses and clocks beside the poses, as reported to users.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/result.h"

namespace rigproof::ml {

/// @param globals covariance of the global unknowns
void report_also_estimated(const Preparation& prepared, const Fit& fit, const GlobalCovariance& globals,
                           Result* result);

}  // namespace rigproof::ml
