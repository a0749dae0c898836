// Derivatives of a corner's pixel by the lens and by the board's shape.
#pragma once

#include <cmath>

#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/calib/estimate/residuals.h"

namespace rigproof::ml {

/// Derivative of the pixel by LensChange, at the lens of the state.
/// @param coefficient_by_px see Lenses @param point in the camera
inline RowJacobian<2, 5> pixel_by_lens(const Camera& lens, const LensChange& change, double coefficient_by_px,
                                       const Eigen::Vector3d& point, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d n = point.head<2>() / point.z(), from_centre = pixel - Eigen::Vector2d(lens.cx_px, lens.cy_px);
  const double radius = n.norm(), angle = std::atan(radius);
  const double cubed =
      lens.lens == Lens::kKannalaBrandt ? (radius > 0.0 ? angle * angle * angle / radius : 0.0) : radius * radius;
  RowJacobian<2, 5> by_lens;
  by_lens.col(0) = from_centre / (1.0 + change[0]);
  by_lens.block<2, 2>(0, 1).setIdentity();
  by_lens.col(3) << 0.5 * from_centre.x() / (1.0 + 0.5 * change[3]), -0.5 * from_centre.y() / (1.0 - 0.5 * change[3]);
  by_lens.col(4) << lens.fx_px * n.x(), lens.fy_px * n.y();
  by_lens.col(4) *= cubed * coefficient_by_px;
  return by_lens;
}

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
