// Bundle adjustment of a pattern: all cameras against all of its poses, by the reprojection of every corner.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pattern_graph.h"
#include "rigproof/core/observations.h"

namespace rigproof::rivals {

struct PatternBundle {
  PatternPart part;
  /// Of T_camera_root of all cameras but the root, six rows each in the order of part.cameras, chart of
  /// transform_error(), scaled by the residuals.
  Eigen::MatrixXd covariance;
  double rms_px = 0.0;
  int corners = 0;
  bool converged = false;
  /// (stop, camera) of views with most corners far off: a flipped start or another board.
  std::vector<std::pair<int, int>> outliers;
};

/// Levenberg-Marquardt with board poses eliminated, Cauchy's loss at three times the median residual of a view.
PatternBundle adjust_pattern(const Observations& observations, const PatternPart& start);

}  // namespace rigproof::rivals
