// A plain image: what the modules hand to each other, so that no public header needs OpenCV.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigproof {

/// Row-major, interleaved channels, no padding. Row 0 is the top row.
template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<T> pixels;

  Image() = default;
  Image(int width_in, int height_in, int channels_in = 1, T fill = T())
      : width(width_in),
        height(height_in),
        channels(channels_in),
        pixels(static_cast<std::size_t>(width_in) * static_cast<std::size_t>(height_in) *
                   static_cast<std::size_t>(channels_in),
               fill) {}

  bool empty() const { return pixels.empty(); }
  std::size_t row_length() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels); }
  T* row(int y) { return pixels.data() + static_cast<std::size_t>(y) * row_length(); }
  const T* row(int y) const { return pixels.data() + static_cast<std::size_t>(y) * row_length(); }
  T& at(int x, int y, int channel = 0) {
    return row(y)[static_cast<std::size_t>(x) * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)];
  }
  const T& at(int x, int y, int channel = 0) const {
    return row(y)[static_cast<std::size_t>(x) * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)];
  }
};

using Image8 = Image<std::uint8_t>;
using Image16 = Image<std::uint16_t>;
using ImageF = Image<float>;

}  // namespace rigproof
