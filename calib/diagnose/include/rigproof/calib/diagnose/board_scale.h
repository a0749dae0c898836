// The board's size, checked by the depth measured on it and by the odometry.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// What the odometry says of lengths: measured = scale * seen by the cameras, in whose eyes
/// the board is as large as stated. Absent: it says nothing to be trusted.
struct OdometryScale {
  double scale = 1.0;
  double sigma = 0.0;
};

struct BoardScale {
  /// Contradictions: the board, a camera's depth or the rig as a whole cannot be trusted.
  std::vector<Finding> contradictions;
  std::vector<Finding> notes;
  bool depth_unit = false;  ///< the depth of a camera is in another unit: no residual of it means anything
  /// ln of measured over expected depth of the board, over all cameras, and its standard deviation; absent: no depth.
  std::optional<double> log_depth_ratio;
  double sigma = 0.0;
};

/// Compares the depth at the board's centre with the distance at which its stated squares look as they do.
///
/// A real sensor's depth scale is itself off by 1 % (one sigma; data sheets promise 2 %), and sensors of one make by
/// the same, so that many cameras are no better than one. Refused is therefore what is beyond 4 of those and of
/// the measurement's own sigmas, or beyond 2.5 when the odometry (2 %, one sigma) says the same and both together are
/// beyond 4.
BoardScale check_board_scale(const Observations& observations, const std::vector<ViewPose>& views,
                             const std::optional<OdometryScale>& odometry);

}  // namespace rigproof::ml
