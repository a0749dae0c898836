// The part of the observations that `ml` uses.
#pragma once

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// Without views that the result leaves out, planes that are not the ground, planes of cameras without a pose, and
/// places of boards.
Observations used_observations(const Result& result, const Observations& observations, const GroundCheck& ground);

/// Without what is stated of where boards stand: `ml` compares that with the drive before it uses it, and what solves
/// without it must not.
Observations without_places(Observations observations);

}  // namespace rigproof
