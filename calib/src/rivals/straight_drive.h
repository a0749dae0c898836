// Which steps of a drive go straight, and which turn.
#pragma once

#include "rigproof/core/observations.h"

namespace rigproof::rivals {

/// The step from one stop to another as the odometry tells it.
struct Step {
  double forward_m = 0.0, left_m = 0.0, turn_rad = 0.0;

  /// Along its own heading, forwards or backwards: at least 5 cm, at most 5 % sideways, turning at most 1.5 degrees.
  bool straight() const;
};
Step step_between(const Observations& observations, int from, int to);

}  // namespace rigproof::rivals
