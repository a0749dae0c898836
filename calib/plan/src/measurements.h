// What to measure, where no drive helps.
#pragma once

#include <optional>

#include "rigproof/calib/plan/suggest.h"
#include "rigproof/core/result.h"

namespace rigproof::suggest {

/// Where most of the worst variance, in units of the limits, comes from what was stated beforehand and is no better
/// known after the drive: what to measure. Absent where drives help, or where nothing is stated.
/// @param then the result that is expected after the drive
std::optional<Finding> what_to_measure(const Result& then, const Suggestion& suggestion);
/// What the largest sigma, in units of the limits, is made of, where further stops do not help.
Finding what_limits(const Result& then, const Suggestion& suggestion, double min_gain);

}  // namespace rigproof::suggest
