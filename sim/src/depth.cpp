#include "depth.h"

#include <cmath>

namespace rigproof {
namespace {

constexpr std::int32_t kFar = (1 << 24) - 1;
// Largest bend of 1/z from pixel to pixel on a surface, relative to 1/z, and in counts of the buffer.
constexpr double kSmoothBend = 2e-3, kSmoothCounts = 4.0;

std::int32_t window_depth(std::uint32_t packed) { return static_cast<std::int32_t>(packed >> 8U); }

// Bend of four samples in a row, of which the middle two are blended.
bool is_smooth(double a, double b, double c, double d, double tolerance) {
  return std::abs(a - 2.0 * b + c) <= tolerance && std::abs(b - 2.0 * c + d) <= tolerance;
}

// Nearness in counts from the far plane; 1/z = slope * (nearness + offset / slope).
double nearness(const WindowDepth& source, int x, int y) { return kFar - window_depth(source.row(y)[x]); }

float depth_of(const mujoco::DepthLaw& law, double nearness_counts) {
  if (nearness_counts <= 0.0) return 0.0F;
  return static_cast<float>(1.0 / (law.offset_per_m + nearness_counts * law.slope_per_m));
}

float sample_depth(const WindowDepth& source, const mujoco::DepthLaw& law, double offset_counts, float x, float y) {
  if (!(x >= -0.5F && y >= -0.5F)) return 0.0F;
  const int nearest_x = static_cast<int>(x + 0.5F), nearest_y = static_cast<int>(y + 0.5F);
  if (nearest_x >= source.width || nearest_y >= source.height) return 0.0F;
  const double nearest = nearness(source, nearest_x, nearest_y);
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const bool inside = ix >= 1 && iy >= 1 && ix + 2 < source.width && iy + 2 < source.height;
  if (!inside || nearest <= 0.0) return depth_of(law, nearest);
  const auto at = [&](int dx, int dy) { return nearness(source, ix + dx, iy + dy); };
  const double tolerance = kSmoothBend * (nearest + offset_counts) + kSmoothCounts;
  const double d00 = at(0, 0), d10 = at(1, 0), d01 = at(0, 1), d11 = at(1, 1);
  const bool smooth =
      is_smooth(at(-1, 0), d00, d10, at(2, 0), tolerance) && is_smooth(at(-1, 1), d01, d11, at(2, 1), tolerance) &&
      is_smooth(at(0, -1), d00, d01, at(0, 2), tolerance) && is_smooth(at(1, -1), d10, d11, at(1, 2), tolerance);
  if (!smooth) return depth_of(law, nearest);
  const double fx = static_cast<double>(x) - ix, fy = static_cast<double>(y) - iy;
  return depth_of(law, (1.0 - fy) * ((1.0 - fx) * d00 + fx * d10) + fy * ((1.0 - fx) * d01 + fx * d11));
}

}  // namespace

void convert_depth(const WindowDepth& source, const mujoco::DepthLaw& law, ImageF* depth_m) {
  depth_m->width = source.width;
  depth_m->height = source.height;
  depth_m->channels = 1;
  depth_m->pixels.resize(static_cast<std::size_t>(source.width) * static_cast<std::size_t>(source.height));
  const auto offset = static_cast<float>(law.offset_per_m), slope = static_cast<float>(law.slope_per_m);
  for (int y = 0; y < source.height; ++y) {
    const std::uint32_t* in = source.row(y);
    float* out = depth_m->row(y);
    for (int x = 0; x < source.width; ++x) {
      // The difference of the integers is exact in float; 1/z from the depth itself would cancel digits.
      const std::int32_t counts = kFar - window_depth(in[x]);
      const float depth = 1.0F / (offset + slope * static_cast<float>(counts));
      out[x] = counts > 0 ? depth : 0.0F;
    }
  }
}

void sample_depth_row(const WindowDepth& source, const mujoco::DepthLaw& law, const float* xs, const float* ys,
                      int count, float* depth_m) {
  const double offset_counts = law.offset_per_m / law.slope_per_m;
  for (int i = 0; i < count; ++i) depth_m[i] = sample_depth(source, law, offset_counts, xs[i], ys[i]);
}

}  // namespace rigproof
