// Yaw of the odometry that drifts with time, as by the bias of a gyro: no odometry model has it.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// The slope of the turns' residuals over the time that they took, beside a factor on the turns.
struct YawDrift {
  double rad_s = 0.0;
  double sigma_rad_s = 0.0;  ///< by the scatter of the residuals
  double redundancy = 0.0;   ///< by how many residuals that scatter is known

  /// As many standard deviations of a Gaussian are as unlikely by chance: Student's t after Wallace, "Bounds on normal
  /// approximations to Student's and the chi-square distributions" (1959).
  double deviations() const;
};
YawDrift estimate_yaw_drift(const Observations& observations, const NoiseLevels& noise, const State& state);

struct FoundDrift {
  Finding finding;
  bool bends = false;  ///< what would be stated without it is wrong by more than its uncertainty allows
};
/// Looked for at the solution, and confirmed by one without the drift.
std::optional<FoundDrift> find_yaw_drift(const Preparation& prepared, const Fit& fit);

}  // namespace rigproof::ml
