// Yaw of the odometry that drifts with time, as by the bias of a gyro: no odometry model has it.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/fit.h"
#include "rigproof/core/finding.h"

namespace rigproof::ml {

/// The slope of the turns' residuals over the time that they took, beside a factor on the turns.
struct YawDrift {
  double rad_s = 0.0;
  double deviations = 0.0;  ///< standard deviations from zero, by the scatter of the residuals
};
YawDrift estimate_yaw_drift(const Observations& observations, const NoiseLevels& noise, const State& state);

struct FoundDrift {
  Finding finding;
  bool bends = false;  ///< what would be stated without it is wrong by more than its uncertainty allows
};
/// Looked for at the solution, and confirmed by one without the drift.
std::optional<FoundDrift> find_yaw_drift(const Preparation& prepared, const Fit& fit);

}  // namespace rigproof::ml
