// Where the corners of a board are that is not quite the stated one.
#pragma once

#include <Eigen/Core>

#include "rigproof/core/board.h"

namespace rigproof::ml {

/// A corner's place on the board as it is, and its derivative by the board's shape (Nuisance::kBoardShape).
struct CornerOfBoard {
  Eigen::Vector3d point;
  Eigen::Matrix<double, 3, 4> by_shape;
};
inline CornerOfBoard corner_of_board(const Board& board, const Eigen::Vector4d& shape, const Eigen::Vector3d& stated) {
  const Eigen::Vector3d from_centre = stated - board.centre();
  // The middle and the edges bow apart; the corners' mean stays nearly where it is.
  const Eigen::Vector2d half = 0.5 * board.square_m * Eigen::Vector2d(board.squares_x, board.squares_y);
  const Eigen::Vector2d bow = from_centre.head<2>().cwiseQuotient(half).cwiseAbs2().array() - 1.0 / 3.0;
  CornerOfBoard corner;
  corner.by_shape.col(0) = from_centre;
  corner.by_shape.col(1) << 0.5 * from_centre.x(), -0.5 * from_centre.y(), 0.0;
  corner.by_shape.rightCols<2>() << 0.0, 0.0, 0.0, 0.0, bow.x(), bow.y();
  corner.point = stated + corner.by_shape * shape;
  return corner;
}

}  // namespace rigproof::ml
