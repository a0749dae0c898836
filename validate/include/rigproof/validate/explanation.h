// Why checks fail: the simplest single cause that explains all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/budget.h"

namespace rigproof {

struct Explanation {
  Finding cause;              ///< errors.one_axis, ..
  int axis = -1;              ///< of errors.one_axis and errors.shared_axis
  std::size_t explained = 0;  ///< failing checks that it explains: all of them
};

/// Where an error along or about these axes comes from that all cameras share: a value `source`, "odometry", "ground"
/// or both; `deviations` where it is beyond four standard deviations of the comparison's bound, so that neither can
/// be. None without a bound: who can say.
/// @param axes 0 to 5 = tx .. rz
FindingValues source_of_shared(const Comparison& comparison, const std::vector<int>& axes);

/// Undoes one cause at a time and applies the budget again: one camera along one axis; all cameras displaced alike
/// along one axis of the robot; one factor of all distances from the robot's origin; one camera's whole pose; all
/// cameras together, as one rigid body. The first cause without which nothing fails is the answer. Absent if nothing
/// failed, if a check failed for want of an answer, or if no single cause will do. Of what all cameras share,
/// source_of_shared() is told.
std::optional<Explanation> explain_failures(const Comparison& comparison, const Budget& budget);

}  // namespace rigproof
