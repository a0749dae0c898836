#include "smooth_image.h"

#include <algorithm>

namespace rigproof::detection {
namespace {

// The binomial needs two pixels more on either side; the image's edge is repeated.
void smooth_row(const std::uint8_t* source, int width, std::vector<std::int16_t>& padded, std::int16_t* target) {
  for (int i = 0; i < width + 4; ++i) padded[static_cast<std::size_t>(i)] = source[std::clamp(i - 2, 0, width - 1)];
  const std::int16_t* p = padded.data();
  for (int x = 0; x < width; ++x)
    target[x] = static_cast<std::int16_t>(p[x] + p[x + 4] + 4 * (p[x + 1] + p[x + 3]) + 6 * p[x + 2]);
}

}  // namespace

SmoothImage smooth(const Image8& grey) {
  const auto width = static_cast<std::size_t>(grey.width);
  std::vector<std::int16_t> horizontal(grey.pixels.size()), padded(width + 4);
  for (int y = 0; y < grey.height; ++y)
    smooth_row(grey.row(y), grey.width, padded, horizontal.data() + static_cast<std::size_t>(y) * width);
  SmoothImage result{grey.width, grey.height, std::vector<std::int16_t>(grey.pixels.size())};
  const auto line = [&](int y) {
    return horizontal.data() + static_cast<std::size_t>(std::clamp(y, 0, grey.height - 1)) * width;
  };
  for (int y = 0; y < grey.height; ++y) {
    const std::int16_t *a = line(y - 2), *b = line(y - 1), *c = line(y), *d = line(y + 1), *e = line(y + 2);
    std::int16_t* target = result.values.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x)
      target[x] = static_cast<std::int16_t>((a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x] + 8) >> 4);
  }
  return result;
}

Image8 halve(const Image8& grey) {
  Image8 half(grey.width / 2, grey.height / 2);
  for (int y = 0; y < half.height; ++y) {
    const std::uint8_t *a = grey.row(2 * y), *b = grey.row(2 * y + 1);
    std::uint8_t* target = half.row(y);
    for (int x = 0; x < half.width; ++x)
      target[x] = static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
  }
  return half;
}

Image8 to_grey(const Image8& image) {
  if (image.channels == 1) return image;
  Image8 grey(image.width, image.height);
  const std::uint8_t* source = image.pixels.data();
  const auto step = static_cast<std::size_t>(image.channels);
  if (image.channels < 3) {
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) grey.pixels[i] = source[i * step];
    return grey;
  }
  // Weights of ITU-R BT.601 in 1/16384, which sum to 1.
  for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
    const std::uint8_t* p = source + i * step;
    grey.pixels[i] = static_cast<std::uint8_t>((4899 * p[0] + 9617 * p[1] + 1868 * p[2] + 8192) >> 14);
  }
  return grey;
}

}  // namespace rigproof::detection
