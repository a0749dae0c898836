// What a result's uncertainty mostly comes from, and what to do about it.
#pragma once

#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// `uncertainty.source`: of each axis of the robot the largest stated sigma of any camera, and how much of it comes
/// from the source that has the largest share; lengths in centimetres, angles in degrees. Axes whose largest share has
/// the same source are one finding, which names the worst camera where others are known better. Empty where nothing is
/// stated.
std::vector<Finding> main_sources(const Result& result);

}  // namespace rigproof
