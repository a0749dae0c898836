#include "sky.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rigproof {

Sky::Sky(const std::array<double, 3>& zenith, const std::array<double, 3>& horizon) {
  for (std::size_t i = 0; i <= kSteps; ++i) {
    // The square root brings the zenith's colour down to where cameras look.
    const double share = std::sqrt(static_cast<double>(i) / kSteps);
    for (std::size_t c = 0; c < 3; ++c)
      colors_[i][c] =
          static_cast<std::uint8_t>(255.0 * std::clamp(horizon[c] + share * (zenith[c] - horizon[c]), 0.0, 1.0) + 0.5);
    colors_[i][3] = 255;
  }
}

void Sky::paint(const Frustum& frustum, const Eigen::Matrix3d& R_world_camera, std::uint8_t* rows_from_bottom) const {
  const float step = static_cast<float>((frustum.x_max - frustum.x_min) / frustum.width);
  const float up_x = static_cast<float>(R_world_camera(2, 0)),
              first_x = static_cast<float>(frustum.x_min) + 0.5F * step;
  for (int row = 0; row < frustum.height; ++row) {
    std::uint8_t* pixels = rows_from_bottom + static_cast<std::ptrdiff_t>(row) * frustum.width * 4;
    const double ray_y = frustum.y_max - (row + 0.5) * (frustum.y_max - frustum.y_min) / frustum.height;
    const float up_yz = static_cast<float>(R_world_camera(2, 1) * ray_y + R_world_camera(2, 2));
    const float square_yz = static_cast<float>(ray_y * ray_y + 1.0);
    for (int column = 0; column < frustum.width; ++column) {
      std::uint8_t* pixel = pixels + 4 * column;
      if (pixel[3] != 0) continue;
      const float ray_x = first_x + step * static_cast<float>(column);
      const float sine = (up_x * ray_x + up_yz) / std::sqrt(ray_x * ray_x + square_yz);
      const auto index = static_cast<std::size_t>(std::clamp(sine, 0.0F, 1.0F) * kSteps + 0.5F);
      std::memcpy(pixel, colors_[index].data(), 4);
    }
  }
}

}  // namespace rigproof
