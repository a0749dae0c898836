// Derivatives of a corner's pixel by the lens.
#pragma once

#include <cmath>

#include "rigproof/calib/estimate/board_shape.h"
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

}  // namespace rigproof::ml
