#include "rigproof/calib/estimate/declared_problem.h"

namespace rigproof::ml {
Problem declared_problem(const Observations& observations, const CalibrationNoise& noise) {
  return Problem(observations, Priors::of({observations, noise.priors, false}),
                 plausible({noise.law,
                            noise.odometry_xy_m,
                            noise.odometry_yaw_rad,
                            noise.suspension_height_m,
                            noise.suspension_tilt_rad,
                            {},
                            {},
                            {}},
                           observations.cameras.size()));
}

}  // namespace rigproof::ml
