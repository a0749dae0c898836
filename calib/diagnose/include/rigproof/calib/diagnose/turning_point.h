// What is known of a camera besides where its robot turns.
#pragma once

#include <cstddef>

#include "rigproof/core/result.h"

namespace rigproof {

/// The variance along or about an axis of a camera in the robot that has a covariance, without the share that is not
/// known of the point about which the robot turns: two calibrations of one robot have that error in common.
double variance_beside_turning_point(const EstimatedTransform& camera, std::size_t axis);

}  // namespace rigproof
