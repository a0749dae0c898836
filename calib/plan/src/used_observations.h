// The part of the observations that `ml` uses.
#pragma once

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// Without views that the result leaves out, planes that are not the ground, and planes of cameras without a pose.
Observations used_observations(const Result& result, const Observations& observations, const GroundCheck& ground);

}  // namespace rigproof
