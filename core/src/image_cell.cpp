#include "rigproof/core/image_cell.h"

#include <algorithm>
#include <cmath>

namespace rigproof {

std::size_t image_cell(const Camera& camera, const Eigen::Vector2d& pixel) {
  const auto part = [](double at, int size, int parts) {
    return std::clamp(static_cast<int>(std::floor((at + 0.5) * parts / size)), 0, parts - 1);
  };
  return static_cast<std::size_t>(part(pixel.y(), camera.height_px, kCellsDown) * kCellsAcross +
                                  part(pixel.x(), camera.width_px, kCellsAcross));
}

}  // namespace rigproof
