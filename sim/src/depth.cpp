#include "depth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "resample.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// Largest bend of 1/z from pixel to pixel on a surface, relative to 1/z, and in counts of the buffer.
constexpr double kSmoothBend = 2e-3, kSmoothCounts = 4.0;

float depth_of(const mujoco::DepthLaw& law, double nearness_counts) {
  if (nearness_counts <= 0.0) return 0.0F;
  return static_cast<float>(1.0 / (law.offset_per_m + nearness_counts * law.slope_per_m));
}

// Slope at the sample c from the smoother of its two sides (a b c and c d e); 0 where neither is smooth.
std::int32_t one_sided_slope(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, std::int32_t e,
                             std::int32_t tolerance) {
  const std::int32_t bend_before = std::abs(a - 2 * b + c), bend_after = std::abs(c - 2 * d + e);
  if (std::min(bend_before, bend_after) > tolerance) return 0;
  return bend_before < bend_after ? c - b : d - c;
}

float sample_depth(const WindowDepth& source, const mujoco::DepthLaw& law, double offset_counts, float x, float y) {
  if (!(x >= -0.5F && y >= -0.5F)) return 0.0F;
  const int ix = static_cast<int>(std::floor(x + 0.5F)), iy = static_cast<int>(std::floor(y + 0.5F));
  if (ix >= source.width || iy >= source.height) return 0.0F;
  const std::uint32_t* centre = source.row(iy) + ix;
  const std::int32_t nearest = nearness(*centre);
  const bool inside = ix >= 2 && iy >= 2 && ix + 2 < source.width && iy + 2 < source.height;
  if (!inside || nearest <= 0) return depth_of(law, nearest);
  const auto tolerance = static_cast<std::int32_t>(kSmoothBend * (nearest + offset_counts) + kSmoothCounts);
  const auto slope = [&](std::ptrdiff_t step) {
    return one_sided_slope(nearness(centre[-2 * step]), nearness(centre[-step]), nearest, nearness(centre[step]),
                           nearness(centre[2 * step]), tolerance);
  };
  const double dx = static_cast<double>(x) - ix, dy = static_cast<double>(y) - iy;
  return depth_of(law, nearest + dx * slope(1) + dy * slope(-static_cast<std::ptrdiff_t>(source.width)));
}

}  // namespace

RIGPROOF_VECTOR_CLONES
void convert_depth(const WindowDepth& source, const mujoco::DepthLaw& law, ImageF* depth_m) {
  resize(source.width, source.height, 1, depth_m);
  const auto offset = static_cast<float>(law.offset_per_m), slope = static_cast<float>(law.slope_per_m);
  for (int y = 0; y < source.height; ++y) {
    const std::uint32_t* in = source.row(y);
    float* out = depth_m->row(y);
    for (int x = 0; x < source.width; ++x) {
      // The difference of the integers is exact in float; 1/z from the depth itself would cancel digits.
      const std::int32_t counts = nearness(in[x]);
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
