#include "rigproof/generator/odometry_errors.h"

namespace rigproof {

void ThrunConfig::visit(FieldVisitor& visitor) {
  visitor.field("a1", a1, {0.0, 1.0}, "variance of a turn per squared turn [rad^2/rad^2]");
  visitor.field("a2", a2, {0.0, 1.0}, "variance of a turn per squared way [rad^2/m^2]");
  visitor.field("a3", a3, {0.0, 1.0}, "variance of a way per squared way [m^2/m^2]");
  visitor.field("a4", a4, {0.0, 1.0}, "variance of a way per squared turns before and after it [m^2/rad^2]");
}

void WheelsConfig::visit(FieldVisitor& visitor) {
  visitor.field("diameter_ratio", diameter_ratio, {0.8, 1.25}, "UMBmark's E_d: right over left wheel");
  visitor.field("track_ratio", track_ratio, {0.5, 2.0}, "UMBmark's E_b: true over nominal effective track");
  visitor.field("icr_x_m", icr_x_m, {-1.0, 1.0}, "the robot turns about the point (icr_x_m, 0) of its frame");
  visitor.field("icr_asymmetry_m", icr_asymmetry_m, {-1.0, 1.0},
                "how far left of the middle the tracks' centres of rotation lie: (y_l + y_r) / 2");
  visitor.field("slip_percent", slip_percent, {0.0, 50.0}, "of the way of either side's wheels, one sigma");
}

}  // namespace rigproof
