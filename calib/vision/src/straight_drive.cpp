#include "rigproof/calib/vision/straight_drive.h"

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::rivals {

bool Step::straight() const {
  return std::abs(forward_m) >= 0.05 && std::abs(left_m) <= 0.05 * std::abs(forward_m) &&
         std::abs(turn_rad) <= deg_to_rad(1.5);
}

bool Step::turns() const { return std::abs(turn_rad) > kMinTurn_rad; }

bool Step::turns_like(double camera_turn_rad) const {
  return std::abs(std::abs(camera_turn_rad) - std::abs(turn_rad)) < 0.5 * std::abs(turn_rad) + kMinTurn_rad;
}

Step step_between(const Observations& observations, int from, int to) {
  const Stop &a = observations.stops[static_cast<std::size_t>(from)],
             &b = observations.stops[static_cast<std::size_t>(to)];
  const double c = std::cos(a.yaw_rad), s = std::sin(a.yaw_rad), dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  return {c * dx + s * dy, -s * dx + c * dy, wrap_angle(b.yaw_rad - a.yaw_rad)};
}

}  // namespace rigproof::rivals
