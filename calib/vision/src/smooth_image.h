// A grey image at one level of the pyramid, smoothed for derivatives.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "rigproof/core/image.h"

namespace rigproof::detection {

/// Grey values times 16, smoothed by the binomial 1 4 6 4 1 (sigma 1 px) along both axes.
struct SmoothImage {
  int width = 0;
  int height = 0;
  std::vector<std::int16_t> values;

  const std::int16_t* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  bool contains(float x, float y) const {
    return x >= 0.0F && y >= 0.0F && x < static_cast<float>(width - 1) && y < static_cast<float>(height - 1);
  }
  /// Bilinear; the position must be inside.
  float sample(float x, float y) const {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const std::int16_t* a = row(iy) + ix;
    const std::int16_t* b = a + width;
    const float top = static_cast<float>(a[0]) + fx * static_cast<float>(a[1] - a[0]);
    const float bottom = static_cast<float>(b[0]) + fx * static_cast<float>(b[1] - b[0]);
    return top + fy * (bottom - top);
  }
};

inline constexpr float kSmoothScale = 16.0F;  ///< SmoothImage units of one grey level

/// Needs an image of one channel, at least 8 pixels wide and high.
SmoothImage smooth(const Image8& grey);

/// Means of 2x2 pixels; pixel (x, y) covers source pixels 2x..2x+1, 2y..2y+1.
Image8 halve(const Image8& grey);

/// One channel: itself, or 0.299 R + 0.587 G + 0.114 B.
Image8 to_grey(const Image8& image);

}  // namespace rigproof::detection
