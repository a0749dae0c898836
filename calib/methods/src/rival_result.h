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

/// Fills Result::use: what observing left out, then what this method did; all other views were used.
void report_use(const Observations& observations, const std::vector<ViewPose>& views,
                const std::vector<Exclusion>& left_out, Result* result);
/// The same, with one reason for every view that was not used.
void report_use(const Observations& observations, const std::vector<ViewPose>& views, const UsedViews& used,
                const Finding& reason_for_others, Result* result);

/// A B^-1, and the derivatives of its error by the errors of A and of B, all in the chart of transform_error().
struct Quotient {
  Quotient(const Rigid3& A, const Rigid3& B);

  Rigid3 T;
  Matrix6d by_A, by_B;
};

/// A camera's pose in the robot, all six degrees.
EstimatedTransform camera_in_robot(const Observations& observations, int camera, const Rigid3& T_robot_camera);

/// Adds the pairs that the cameras' poses in the robot imply, where the method states none itself.
void add_pairs_from_robot(const Observations& observations, Result* result);

/// Sets the status: solved if `complete`, else partial; refused where there is no transform at all.
void conclude(bool complete, Result* result);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& names);

/// Sets the status: solved if every camera has a pose in the robot, partial if some have, else refused.
void conclude_by_cameras(const Observations& observations, Result* result);

}  // namespace rigproof::rivals
