// What every rival reports besides its transforms.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::rivals {

/// (stop, camera) of the views that a method used.
using UsedViews = std::set<std::pair<int, int>>;

/// Fills Result::use: what observing left out, then the views that this method did, with the reason that it gives.
void report_use(const Observations& observations, const std::vector<ViewPose>& views, const UsedViews& used,
                const Finding& reason_for_others, Result* result);

/// A camera's pose in the robot, all six degrees.
EstimatedTransform camera_in_robot(const Observations& observations, int camera, const Rigid3& T_robot_camera);

/// Adds the pairs that the cameras' poses in the robot imply, where the method states none itself.
void add_pairs_from_robot(const Observations& observations, Result* result);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

/// Solved if every camera has a pose in the robot, partial if some have, else refused.
void conclude_by_cameras(const Observations& observations, Result* result);

}  // namespace rigproof::rivals
