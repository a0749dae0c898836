// What is left of the corners when each stop's board is put where it fits them best.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::inspect_detail {

/// A board as it was estimated.
struct ShapedBoard {
  const Board& stated;    ///< with the estimated size
  Eigen::Vector4d shape;  ///< as board_shapes() has it

  Eigen::Vector3d corner(int id) const;  ///< [m, board frame]
};
/// T_camera_board of one view of a robot that stands, weighted by the corners' covariances; absent where nothing fits.
std::optional<Rigid3> pose_of_board(const BoardView& view, const ShapedBoard& board, const Camera& camera);

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
