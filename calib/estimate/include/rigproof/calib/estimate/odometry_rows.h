// Single odometry rows that contradict the cameras, and stamps that run ahead or behind.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// A row, or a motion between two rows, that no noise explains.
struct WildRow {
  int stop = 0;
  bool slip = false;  ///< the motion to this stop is wrong, and what follows agrees again
  double off_m = 0.0;
  double off_rad = 0.0;
};
std::vector<WildRow> find_wild_rows(const Observations& observations, const NoiseLevels& noise, const State& state);
/// A note that it is ignored.
Finding finding_of(const WildRow& row, const Observations& observations);

/// By how many stops the odometry runs ahead of the images, from the slope of the residuals along the drive.
struct StampShift {
  double stops = 0.0;
  double deviations = 0.0;  ///< standard deviations from zero
  bool contradicts() const;
};
StampShift estimate_stamp_shift(const Observations& observations, const NoiseLevels& noise, const State& state);

}  // namespace rigproof::ml
