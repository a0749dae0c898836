// The sky behind everything: a gradient by elevation, painted where GL drew nothing.
#pragma once

#include <array>
#include <cstdint>

#include "gl_scene.h"

namespace rigproof {

class Sky {
 public:
  Sky(const std::array<double, 3>& zenith, const std::array<double, 3>& horizon);
  /// Fills the pixels of alpha 0 of a picture drawn through the frustum. `rows_from_bottom` is GL's memory.
  void paint(const Frustum& frustum, const Eigen::Matrix3d& R_world_camera, std::uint8_t* rows_from_bottom) const;

 private:
  static constexpr int kSteps = 1024;
  std::array<std::array<std::uint8_t, 4>, kSteps + 1> colors_{};  // by the sine of elevation, 0 to 1
};

}  // namespace rigproof
