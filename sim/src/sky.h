// The sky behind everything: a gradient by elevation with clouds, painted where GL drew nothing.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gl_scene.h"

namespace rigproof {

class Sky {
 public:
  /// Where the clouds are follows from the seed.
  Sky(const SceneDescription& scene, std::uint64_t seed);
  /// Fills the pixels of alpha 0 of a picture drawn through the frustum. `rows_from_bottom` is GL's memory.
  void paint(const Frustum& frustum, const Eigen::Matrix3d& R_world_camera, std::uint8_t* rows_from_bottom) const;

 private:
  using Rgba = std::array<std::uint8_t, 4>;
  void paint_cloud(float east, float north, float up, std::uint8_t* pixel) const;

  static constexpr int kSteps = 1024;
  std::array<Rgba, kSteps + 1> colors_{};  // by the sine of elevation, 0 to 1
  static constexpr int kCloudSize = 512;
  std::vector<std::uint8_t> clouds_;  // opacity over a layer above the world, seamless; empty = none
  Rgba cloud_color_{};
};

}  // namespace rigproof
