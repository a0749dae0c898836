// Compares poses and says how far apart they are.
#pragma once

#include <gtest/gtest.h>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Holds if the two transforms differ by at most distance_m and angle_rad; prints both differences otherwise.
inline testing::AssertionResult IsPoseNear(const Rigid3& expected, const Rigid3& actual, double distance_m,
                                           double angle_rad) {
  const Vector6d error = transform_error(actual, expected);
  const double distance = error.head<3>().norm(), angle = error.tail<3>().norm();
  if (distance <= distance_m && angle <= angle_rad) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "poses differ by " << distance << " m (allowed " << distance_m << ") and "
                                     << rad_to_deg(angle) << " deg (allowed " << rad_to_deg(angle_rad) << "); error "
                                     << error.transpose();
}

}  // namespace rigproof
