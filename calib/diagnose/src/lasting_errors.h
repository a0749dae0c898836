// What another drive of the same robot can start from.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/result.h"

namespace rigproof::ml {

/// Absent where the result has no joint covariance, or where all is believed.
std::optional<LastingErrors> lasting_errors(const Preparation& prepared, const Fit& fit,
                                            const GlobalCovariance& globals, const Result& result);

}  // namespace rigproof::ml
