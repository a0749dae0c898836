#include "rigproof/generator/wheel_odometer.h"

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {
namespace {

// sin(x) / x.
double sinc(double x) { return std::abs(x) < 1e-6 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

}  // namespace

WheelOdometer::WheelOdometer(const WheelGeometry& geometry, double left_rad, double right_rad)
    : geometry_(geometry), left_(reading(left_rad)), right_(reading(right_rad)) {}

// Encoders count whole ticks.
double WheelOdometer::reading(double angle_rad) const {
  if (geometry_.ticks_per_turn <= 0.0) return angle_rad;
  return std::floor(angle_rad / (2.0 * kPi) * geometry_.ticks_per_turn) * (2.0 * kPi / geometry_.ticks_per_turn);
}

OdometrySample WheelOdometer::update(double stamp_s, double left_rad, double right_rad) {
  const double left = reading(left_rad), right = reading(right_rad);
  const double way_left = geometry_.wheel_radius_m * (left - left_);
  const double way_right = geometry_.wheel_radius_m * (right - right_);
  left_ = left;
  right_ = right;
  const double turn = (way_right - way_left) / geometry_.effective_track_m;
  const double chord = 0.5 * (way_right + way_left) * sinc(0.5 * turn);
  x_m_ += chord * std::cos(yaw_rad_ + 0.5 * turn);
  y_m_ += chord * std::sin(yaw_rad_ + 0.5 * turn);
  yaw_rad_ = wrap_angle(yaw_rad_ + turn);
  return {stamp_s, x_m_, y_m_, yaw_rad_};
}

}  // namespace rigproof
