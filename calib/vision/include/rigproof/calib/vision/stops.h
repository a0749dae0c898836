// Which frames belong together, and where the robot stood.
#pragma once

#include <vector>

#include "rigproof/calib/vision/observe.h"

namespace rigproof::detection {

/// A stop and the frames of each camera that could stand for it, by stamp; usually one.
struct PlannedStop {
  Stop stop;
  std::vector<std::vector<int>> frames;  ///< [camera], indices into Recording::frames[camera]
};

struct StopPlan {
  std::vector<PlannedStop> stops;     ///< in the order of driving
  std::vector<Exclusion> exclusions;  ///< frames without odometry, and surplus frames of a standstill
};

struct TimeSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Frames closer in time than stop_tolerance_s form one stop, and so do all frames between which the odometer stood
/// still, but for spans in which the robot is known to have moved. Of a standstill at most kFramesPerStandstill frames
/// a camera are kept, evenly spread. Throws Error if there is no frame at all, or if no frame meets the odometry.
StopPlan plan_stops(const Recording& recording, const ObserveOptions& options, const std::vector<TimeSpan>& moved = {});

inline constexpr std::size_t kFramesPerStandstill = 3;

}  // namespace rigproof::detection
