#include "fine_field.h"

#include <algorithm>
#include <cmath>

namespace rigproof::ml {
namespace {

// Cubic B-splines around a place between two nodes, u from the first one.
std::array<double, 4> cubic(double u) {
  const double v = 1.0 - u;
  return {v * v * v / 6.0, (4.0 - 3.0 * u * u * (2.0 - u)) / 6.0, (4.0 - 3.0 * v * v * (2.0 - v)) / 6.0,
          u * u * u / 6.0};
}

}  // namespace

FineField::FineField(const Camera& camera, int cells) {
  const double longer = std::max(camera.width_px, camera.height_px);
  cell_px_ = longer / cells;
  across_ = static_cast<int>(std::ceil(camera.width_px / cell_px_)) + 3;
  down_ = static_cast<int>(std::ceil(camera.height_px / cell_px_)) + 3;
}

std::array<FineField::Share, 16> FineField::at(const Eigen::Vector2d& pixel) const {
  const double x = std::clamp(pixel.x() / cell_px_, 0.0, across_ - 3.0 - 1e-9),
               y = std::clamp(pixel.y() / cell_px_, 0.0, down_ - 3.0 - 1e-9);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const std::array<double, 4> by_x = cubic(x - left), by_y = cubic(y - top);
  std::array<Share, 16> shares;
  for (int i = 0; i < 16; ++i)
    shares[static_cast<std::size_t>(i)] = {
        (top + i / 4) * across_ + left + i % 4,
        by_x[static_cast<std::size_t>(i % 4)] * by_y[static_cast<std::size_t>(i / 4)]};
  return shares;
}

Eigen::Vector2d FineField::pixel_of(int node) const {
  return cell_px_ * Eigen::Vector2d(node % across_ - 1, node / across_ - 1);
}

}  // namespace rigproof::ml
