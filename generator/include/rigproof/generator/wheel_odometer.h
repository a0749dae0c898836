// What wheel encoders tell: ticks, and the pose that a robot's own driver makes of them.
#pragma once

#include "rigproof/core/recording.h"

namespace rigproof {

/// What the driver of the robot believes about its wheels.
struct WheelGeometry {
  double wheel_radius_m = 0.165;
  /// Distance of the wheels at which they would roll without slip as the robot turns. Of a skid-steered robot: the
  /// track times the separation multiplier (Husky: 0.57 m times 1.875).
  double effective_track_m = 1.06875;
  double ticks_per_turn = 0.0;  ///< of the encoders, per turn of a wheel; 0 = continuous
};

/// Integrates the wheels' turns to a pose that begins at (0, 0, 0): between two samples the robot drives the arc
///   ds = (dR + dL) / 2,  dtheta = (dR - dL) / b,  with dR, dL = r 2 pi ticks / ticks_per_turn.
class WheelOdometer {
 public:
  /// @param left_rad, right_rad angles of the wheels at the beginning
  WheelOdometer(const WheelGeometry& geometry, double left_rad, double right_rad);

  /// The pose after the wheels have turned to these angles.
  OdometrySample update(double stamp_s, double left_rad, double right_rad);

 private:
  double reading(double angle_rad) const;

  WheelGeometry geometry_;
  double left_, right_;  ///< last readings [rad]
  double x_m_ = 0.0, y_m_ = 0.0, yaw_rad_ = 0.0;
};

}  // namespace rigproof
