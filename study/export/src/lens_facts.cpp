#include <algorithm>

#include "rigproof/study/export/export.h"

namespace rigproof {

const Camera* ExportCamera::intrinsics() const {
  if (estimated) return &*estimated;
  return told ? &*told : nullptr;
}

double largest_pixel_difference(const Camera& a, const Camera& b) {
  constexpr int kSteps = 16;
  double largest = 0.0;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((a.width_px - 1) * i / double{kSteps}, (a.height_px - 1) * j / double{kSteps});
      Eigen::Vector3d ray;
      Eigen::Vector2d there;
      if (a.unproject(pixel, &ray) && b.project(ray, &there)) largest = std::max(largest, (there - pixel).norm());
    }
  return largest;
}

}  // namespace rigproof
