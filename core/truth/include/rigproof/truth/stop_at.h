// Where the robot truly was at a stamp that was observed.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "rigproof/truth/truth.h"

namespace rigproof {

/// Index of the stop at a stamp, within half a second or half the distance of two stops, whichever is less.
/// @param stops of the truth or of one of its cameras
std::optional<std::size_t> stop_at(const std::vector<TrueStop>& stops, double stamp_s);

/// Pose of the robot in the world at the stop of a stamp; of cameras without a common trigger, which have stops of
/// their own, the nearest counts.
std::optional<Rigid3> robot_at(const Truth& truth, double stamp_s);

}  // namespace rigproof
