// The board's size, checked by the depth measured on it and by the odometry.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Scale of the odometry: measured = scale * length seen by the cameras, given the stated board size. Absent if it
/// cannot be trusted.
struct OdometryScale {
  double scale = 1.0;
  double sigma = 0.0;
};

struct BoardScale {
  /// Contradictions: the board, a camera's depth or the rig as a whole cannot be trusted.
  std::vector<Finding> contradictions;
  std::vector<Finding> notes;
  bool depth_unit = false;  ///< the depth of a camera is in another unit: no residual of it means anything
  /// Of each board with depth on it: ln of measured over expected depth, over the cameras (by index) that agree.
  struct Ratio {
    int board;
    double log_depth_ratio;
    std::vector<int> cameras;
  };
  std::vector<Ratio> ratios;
};

/// Compares the depth at the board's centre with the distance at which its stated squares look as they do.
///
/// How far depth may be off is what the rig says, as the estimate takes it: its scale and the part of it that sensors
/// of one make share, so that many cameras are no better than one, its offset and its fixed error. The board's size and
/// the focal length add what the observations say of them: those may hold estimated lenses. Refused is a deviation
/// beyond 4 sigmas of all, or beyond 2.5 if the odometry (2 %, one sigma) agrees and both together are beyond 4. Of
/// several boards each is judged by the cameras that differ from others on none, and without the odometry, whose scale
/// is that of all boards together.
BoardScale check_board_scale(const Observations& observations, const std::vector<ViewPose>& views,
                             const std::optional<OdometryScale>& odometry);

}  // namespace rigproof::ml
