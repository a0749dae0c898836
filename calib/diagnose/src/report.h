// From a solution to the result that users see: transforms with their uncertainty, refusals and the use of each camera.
#pragma once

#include "examination.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// @param other the solution of the next best odometry model, where it is not out of the question; else null
void report_solution(const Preparation& prepared, const Fit& fit, const Fit* other, const Examination& found,
                     MlEstimate* estimate);
/// What each camera contributed and what was left out of it. @param fit null where nothing was solved
void report_use(const Preparation& prepared, const Fit* fit, Result* result);

}  // namespace rigproof::ml
