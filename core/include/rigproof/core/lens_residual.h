// What a lens does that the coefficients of its model do not follow: a smooth, fixed displacement of the image.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/random.h"

namespace rigproof {

/// Cubic B-splines over a lattice of displacements. A point that the camera's model projects to a pixel appears at
/// pixel + at(pixel). Node (i, j) has its middle at ((i - 2) cell_px, (j - 2) cell_px).
struct LensResidual {
  double cell_px = 160.0;
  int columns = 0;                   ///< of the lattice; as many rows as there are numbers for
  std::vector<double> dx_px, dy_px;  ///< coefficients, row by row

  int rows() const { return columns == 0 ? 0 : static_cast<int>(dx_px.size()) / columns; }
  /// Displacement at a pixel; beyond the lattice that of its rim.
  Eigen::Vector2d at(const Eigen::Vector2d& pixel) const;
};

/// Draws a field with the given root mean square, a coordinate, over the image. Over the image it is orthogonal to what
/// a calibration follows: principal point, focal lengths, roll about the axis, and every coefficient of the lens models
/// (radial to the seventh power, to the ninth for Kannala-Brandt, and tangential).
/// @param cells lattice cells across the longer side, 4 or more
LensResidual draw_lens_residual(const Camera& camera, double rms_px, double cells, RandomStream random);

/// Camera::project() and Camera::unproject() through a lens that has a field, if it has one.
bool project(const Camera& camera, const std::optional<LensResidual>& field, const Eigen::Vector3d& p_camera,
             Eigen::Vector2d* pixel);
bool unproject(const Camera& camera, const std::optional<LensResidual>& field, const Eigen::Vector2d& pixel,
               Eigen::Vector3d* ray);

}  // namespace rigproof
