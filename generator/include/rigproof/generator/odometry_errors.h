// Odometry errors from the literature on mobile robots, for motion: teleport.
#pragma once

#include "rigproof/core/fields.h"

namespace rigproof {

/// Noise that grows with the motion (Thrun, Burgard, Fox: Probabilistic Robotics, 2005, section 5.4). Units: a1 rad^2 a
/// rad^2, a2 rad^2 a m^2, a3 m^2 a m^2, a4 m^2 a rad^2.
struct ThrunConfig {
  double a1 = 0.0025;
  double a2 = 0.0001;
  double a3 = 0.0004;
  double a4 = 0.0001;

  void visit(FieldVisitor& visitor);
};

/// Wheels that are not what the driver believes: UMBmark's systematic errors (Borenstein and Feng, 1996), the centres
/// of rotation of skid steering (Martinez, Mandow et al., 2005), slip, and whole encoder ticks.
struct WheelsConfig {
  Distribution diameter_ratio = 1.0;
  Distribution track_ratio = 1.0;
  Distribution icr_x_m = 0.0;
  Distribution icr_asymmetry_m = 0.0;
  double slip_percent = 1.0;

  void visit(FieldVisitor& visitor);
};

}  // namespace rigproof
