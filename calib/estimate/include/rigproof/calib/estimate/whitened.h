// Observations as the factors take them: whitened by their stated covariances, once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

struct WhitenedView {
  struct Corner {
    int id;
    Eigen::Vector3d point_board;
    Eigen::Vector2d pixel;
    Eigen::Matrix2d whitening;
  };
  int stop, camera;
  double after_stop_s;  ///< by the stamps; 0 where the robot stands
  std::vector<Corner> corners;
  int board = 0;
};

struct WhitenedPlane {
  int stop, camera;
  double after_stop_s;
  Eigen::Vector3d measured;
  Eigen::Matrix3d whitening;
  bool registered;            ///< errs with the intrinsics
  double mean_inverse_depth;  ///< of its points, by their weights [1/m]
  int board = 0;              ///< of a plane on a board: which
};

/// The corners of a view; one whose covariance is of no use has no finite whitening.
std::vector<WhitenedView::Corner> whitened_corners(const BoardView& view, const Board& board);

struct Whitened {
  std::vector<WhitenedView> views;  ///< one for each board view, without corners whose covariance is of no use
  std::vector<WhitenedPlane> ground_planes, board_planes;
  std::vector<Lenses> lenses;  ///< of each camera
};
Whitened whitened(const Observations& observations);
/// The same where corners lie elsewhere, by less than a pixel: planes and their covariances hardly depend on that, and
/// stay as they are.
Whitened with_corners_of(const Observations& observations, const Whitened& before);

}  // namespace rigproof::ml
