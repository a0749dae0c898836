// What of the observations `ml` really uses.
#pragma once

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// Without the views that the result leaves out, the planes that are not the ground and those of cameras that have no
/// pose.
Observations used_observations(const Result& result, const Observations& observations, const GroundCheck& ground);

}  // namespace rigproof
