// Noise levels by which uncertainty is stated and by which it is judged: estimated ones are themselves uncertain.
#pragma once

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// By which the uncertainty is stated.
NoiseLevels stated_levels(const Preparation& prepared, const Fit& fit, const GroupSums& sums);
/// By which is judged whether an answer is of use.
NoiseLevels gate_levels(const Preparation& prepared, const Fit& fit, const GroupSums& sums);

}  // namespace rigproof::ml
