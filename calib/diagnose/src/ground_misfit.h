// Ground planes that contradict each other, or the vertical of the motion, by more than sensor and floor can make them.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// One finding for each camera whose ground planes are off by more than is explained: `ground.off_slightly`, or
/// `ground.off` where nothing that rests on them can be trusted. Explained are their stated noise, what they are known
/// to have wrong, and a floor as uneven as the suspension's levels say.
/// @param sums of the solution, with leverage
std::vector<Finding> find_ground_misfits(const Preparation& prepared, const Fit& fit, const GroupSums& sums);

}  // namespace rigproof::ml
