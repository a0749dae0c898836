// Frames for which there is no odometry: of other clocks or units, or in its gaps.
#pragma once

#include <optional>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Where half of all frames or more are left out for it.
std::optional<Finding> find_missed_frames(const Observations& observations);

}  // namespace rigproof::ml
