// Where boards stand against the first one, as somebody measured it: a prior of their relative poses.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/state.h"
#include "rigproof/core/board.h"

namespace rigproof::ml {

/// By how much a state has a board elsewhere than stated: along the axes of the first board [m], then about its own
/// axes [rad]. Linear in the steps of both poses, to first order.
struct PlaceError {
  int board = 1;
  Vector6d value, sigma;
  Matrix6d by_first, by_board;

  Matrix6d information() const { return sigma.cwiseAbs2().cwiseInverse().asDiagonal(); }
  /// The derivative by all global unknowns, 6 x globals.
  Eigen::MatrixXd by_globals(const Layout& layout) const;
};

PlaceError place_error(const State& state, int board, const BoardPlace& place);

}  // namespace rigproof::ml
