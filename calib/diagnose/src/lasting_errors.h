// What another drive of the same robot can start from.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/result.h"

namespace rigproof::ml {

/// Absent where the result has no joint covariance, or where all is believed.
std::optional<LastingErrors> lasting_errors(const Preparation& prepared, const OdometryChoice& choice,
                                            const GlobalCovariance& globals, const Result& result);

}  // namespace rigproof::ml
