// Which steps of a drive go straight, and which turn.
#pragma once

#include "rigproof/core/conventions.h"
#include "rigproof/core/observations.h"

namespace rigproof::rivals {

inline const double kMinTurn_rad = deg_to_rad(2.0);

/// The step from one stop to another by odometry.
struct Step {
  double forward_m = 0.0, left_m = 0.0, turn_rad = 0.0;

  /// Along its own heading, forwards or backwards: at least 5 cm, at most 5 % sideways, turning at most 1.5 degrees.
  bool straight() const;
  /// By at least kMinTurn_rad, so that images determine the axis.
  bool turns() const;
  /// Camera and robot turn by the same angle: whether the angle from the images agrees, with a tolerance of half of it
  /// and kMinTurn_rad. Wrong matches give arbitrary angles, of which large ones would have the largest weight.
  bool turns_like(double camera_turn_rad) const;
};
Step step_between(const Observations& observations, int from, int to);

}  // namespace rigproof::rivals
