// What is left of the corners when each stop's board is put where it fits them best.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::inspect_detail {

/// Detected corners minus those of the board that fits all views of a stop best, through the rig, the lenses and the
/// size of the board as the result has them.
struct CornerFit {
  /// Of each board view of the observations: [du, dv] of its corners [px], NaN where the board is out of sight; empty
  /// where there is no fit.
  std::vector<std::vector<Eigen::Vector2d>> differences;
  std::size_t corners = 0;
  std::size_t boards = 0;  ///< that were fitted, six unknowns each
  double rms_px = 0.0;     ///< of du and dv
  double stated_px = 0.0;  ///< what the corners' covariances and the stated residual of the lenses let expect

  /// The share of the detector's noise that the fit leaves.
  double shrink() const;
};
CornerFit fit_corners(const Observations& observations, const Result& result);

}  // namespace rigproof::inspect_detail
