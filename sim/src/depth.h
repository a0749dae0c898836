// Metric depth from the window depth that GL stores.
#pragma once

#include <cstdint>

#include "mujoco_compat.h"
#include "rigproof/core/image.h"

namespace rigproof {

/// 24-bit window depths, bottom row first, with 8 bits of stencil below.
struct WindowDepth {
  const std::uint32_t* bottom = nullptr;
  int width = 0;
  int height = 0;

  const std::uint32_t* row(int y) const { return bottom + static_cast<std::ptrdiff_t>(height - 1 - y) * width; }
};

/// Counts of a packed window depth from the far plane: 0 is there, 2^24 - 1 at the near plane.
inline std::int32_t nearness(std::uint32_t packed) { return ((1 << 24) - 1) - static_cast<std::int32_t>(packed >> 8U); }
/// A packed window depth with another count; the stencil stays.
inline std::uint32_t packed_depth(std::int32_t nearness_counts, std::uint32_t before) {
  return (static_cast<std::uint32_t>(((1 << 24) - 1) - nearness_counts) << 8U) | (before & 0xFFU);
}

/// Every pixel's depth as it is; 0 at the far plane. `depth_m` is resized.
void convert_depth(const WindowDepth& source, const mujoco::DepthLaw& law, ImageF* depth_m);

/// Depth of a row of pixels at (xs, ys) of the source: the nearest sample's, carried along the slope of the surface
/// that it lies on. 1/z is linear in the picture of a plane, so this is exact on planes, and edges stay sharp. Outside:
/// 0.
void sample_depth_row(const WindowDepth& source, const mujoco::DepthLaw& law, const float* xs, const float* ys,
                      int count, float* depth_m);

}  // namespace rigproof
