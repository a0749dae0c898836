// Why checks fail: the simplest single cause that explains all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/budget.h"

namespace rigproof {

struct Explanation {
  enum class Kind {
    kOneAxis,       ///< one camera, one axis
    kSharedAxis,    ///< all cameras are displaced alike along one axis of the robot
    kScale,         ///< all distances from the robot's origin are too long or too short by one factor
    kOneCamera,     ///< one camera's whole pose
    kSharedMotion,  ///< all cameras together, as one rigid body
  };
  Kind kind = Kind::kOneAxis;
  std::string camera;         ///< for kOneAxis and kOneCamera
  int axis = -1;              ///< for kOneAxis and kSharedAxis
  double value = 0.0;         ///< metres, radians, or the relative error of the scale
  std::string sentence;       ///< "right is 0.62 cm too high"
  std::size_t explained = 0;  ///< failing checks that it explains: all of them
};

/// " (odometry)", " (ground)": where an error along or about these axes comes from that all cameras share; ", far more
/// than the data allow" where it is beyond four standard deviations of the comparison's bound, so that neither can be.
/// Empty without a bound: who can say.
/// @param axes 0 to 5 = tx .. rz
std::string source_of_shared(const Comparison& comparison, const std::vector<int>& axes);

/// Undoes one cause at a time, in the order of Kind, and applies the budget again; the first cause without which
/// nothing fails is the answer. Absent if nothing failed, if a check failed for want of an answer, or if no single
/// cause will do. Of what all cameras share, source_of_shared() is told.
std::optional<Explanation> explain_failures(const Comparison& comparison, const Budget& budget);

}  // namespace rigproof
