// The covariance of a solution's global unknowns.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// By the given levels, with what is left of errors that repeat in every image; absent where the poses are not
/// determined.
std::optional<GlobalCovariance> covariance_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels);

}  // namespace rigproof::ml
