#include "sky.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "noise.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

// The layer of clouds bends towards the horizon, so that clouds there stay wider than a pixel.
constexpr float kLayerBend = 0.12F;
// Pictures of clouds for one unit of distance over height.
constexpr float kLayerScale = 0.22F;
// Below this sine of elevation haze hides the clouds.
constexpr float kHaze = 0.10F;

std::uint8_t byte(double level) { return static_cast<std::uint8_t>(255.0 * std::clamp(level, 0.0, 1.0) + 0.5); }

}  // namespace

Sky::Sky(const SceneDescription& scene, std::uint64_t seed) {
  for (std::size_t i = 0; i <= kSteps; ++i) {
    // The square root brings the zenith's colour down to where cameras look.
    const double share = std::sqrt(static_cast<double>(i) / kSteps);
    for (std::size_t c = 0; c < 3; ++c)
      colors_[i][c] = byte(scene.sky_horizon[c] + share * (scene.sky_zenith[c] - scene.sky_horizon[c]));
    colors_[i][3] = 255;
  }
  if (scene.cloud_cover <= 0.0) return;
  for (std::size_t c = 0; c < 3; ++c) cloud_color_[c] = byte(scene.cloud_color[c]);
  RandomStream random(seed, "clouds");
  const NoiseField noise = fractal_noise(kCloudSize, random.next_u32(), 6, 6, 6, 0.55F);
  // The share of a standard normal number above the threshold is about the cover.
  const float threshold = 3.2F * (0.5F - static_cast<float>(scene.cloud_cover));
  for (const float value : noise.values)
    clouds_.push_back(byte(std::clamp(0.9 * static_cast<double>(value - threshold), 0.0, 0.95)));
}

void Sky::paint_cloud(float east, float north, float up, std::uint8_t* pixel) const {
  const float scale = kLayerScale * kCloudSize / (std::max(up, 0.0F) + kLayerBend);
  const auto column = static_cast<unsigned>(static_cast<int>(std::floor(scale * east))) % kCloudSize;
  const auto row = static_cast<unsigned>(static_cast<int>(std::floor(scale * north))) % kCloudSize;
  const int through_haze = static_cast<int>(256.0F * std::clamp(up / kHaze, 0.0F, 1.0F));
  const int opacity = clouds_[row * kCloudSize + column] * through_haze / 256;
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - opacity) + cloud_color_[c] * opacity) / 255);
}

void Sky::paint(const Frustum& frustum, const Eigen::Matrix3d& R_world_camera, std::uint8_t* rows_from_bottom) const {
  const float step = static_cast<float>((frustum.x_max - frustum.x_min) / frustum.width);
  const Eigen::Vector3f right = R_world_camera.col(0).cast<float>();
  const float first_x = static_cast<float>(frustum.x_min) + 0.5F * step;
  for (int row = 0; row < frustum.height; ++row) {
    std::uint8_t* pixels = rows_from_bottom + static_cast<std::ptrdiff_t>(row) * frustum.width * 4;
    const double ray_y = frustum.y_max - (row + 0.5) * (frustum.y_max - frustum.y_min) / frustum.height;
    const Eigen::Vector3f along = (R_world_camera.col(1) * ray_y + R_world_camera.col(2)).cast<float>();
    const float square_yz = static_cast<float>(ray_y * ray_y + 1.0);
    for (int column = 0; column < frustum.width; ++column) {
      std::uint8_t* pixel = pixels + 4 * column;
      if (pixel[3] != 0) continue;
      const float ray_x = first_x + step * static_cast<float>(column);
      const float length = std::sqrt(ray_x * ray_x + square_yz);
      const float sine = (right.z() * ray_x + along.z()) / length;
      const auto index = static_cast<std::size_t>(std::clamp(sine, 0.0F, 1.0F) * kSteps + 0.5F);
      std::memcpy(pixel, colors_[index].data(), 4);
      if (!clouds_.empty())
        paint_cloud((right.x() * ray_x + along.x()) / length, (right.y() * ray_x + along.y()) / length, sine, pixel);
    }
  }
}

}  // namespace rigproof
