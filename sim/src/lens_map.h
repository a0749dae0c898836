// Rays of a camera's pixels, quickly: the lens inverted on a coarse grid and interpolated.
#pragma once

#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/lens_residual.h"

namespace rigproof {

/// Bounds of a bundle of rays normalised to z = 1.
struct RayBounds {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
};

/// Rays (x/z, y/z) of all pixels of a camera, and of a border around the image. Interpolation is cubic on a grid of
/// 8 px: below 3e-4 px even for a wide fisheye. Not a number where the lens has no ray within kMaxTangent.
class LensMap {
 public:
  /// Beyond 75 degrees off the axis a flat picture of the world holds next to nothing.
  static constexpr double kMaxTangent = 3.73;
  /// Pixels around the image that the map reaches.
  static constexpr int kBorder = 16;

  /// Throws Error if the middle of an image border looks more than 75 degrees away from the axis.
  explicit LensMap(const Camera& camera, const std::optional<LensResidual>& field = std::nullopt);

  /// Rays of the pixels (first + i * step, row), i < count, which may be fractional.
  void rays_of_row(double row, double first, double step, int count, double* xs, double* ys) const;

 private:
  static constexpr int kCell = 8;
  double node_x(int column) const { return (column - 1) * kCell - kBorder; }

  int columns_ = 0;
  int rows_ = 0;
  std::vector<double> x_, y_;  // row-major nodes
  mutable std::vector<double> line_x_, line_y_;
};

}  // namespace rigproof
