// Odometry that stands still while the cameras see the robot move.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// More than one in five motions that cameras saw are missing in the odometry: encoders that do not count, a driver
/// that hung. Or, if it contradicts the cameras for some reason, one of its columns never changes.
std::optional<Finding> find_dead_odometry(const Observations& observations, const std::vector<ViewPose>& views,
                                          bool contradicted);

}  // namespace rigproof::ml
