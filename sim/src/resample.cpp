#include "resample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

constexpr int kChannels = 4;

// Samples of a Gaussian at 0, 1, 2, ..; as many as weigh at least 1e-4 of the whole.
std::vector<double> gaussian_half(double sigma) {
  std::vector<double> half = {1.0};
  if (sigma > 0.0)
    for (int i = 1; i <= static_cast<int>(std::ceil(3.9 * sigma)); ++i)
      half.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  double sum = half[0];
  for (std::size_t i = 1; i < half.size(); ++i) sum += 2.0 * half[i];
  for (double& weight : half) weight /= sum;
  return half;
}

// line = centre row weighted plus pairs of rows above and below.
RIGPROOF_VECTOR_CLONES
void blur_rows(const RgbaView& source, int y, const std::vector<std::uint16_t>& taps, std::uint8_t* line) {
  const int radius = static_cast<int>(taps.size()) - 1, length = source.width * kChannels;
  const std::uint8_t* rows[2 * 16 + 1];
  const auto clamped = [&](int row) { return source.row(std::clamp(row, 0, source.height - 1)); };
  for (int i = -radius; i <= radius; ++i) rows[radius + i] = clamped(y + i);
  if (radius == 2) {  // the usual kernel, unrolled so that it vectorises
    const std::uint8_t *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
    const std::uint16_t t0 = taps[0], t1 = taps[1], t2 = taps[2];
    for (int i = 0; i < length; ++i)
      line[i] = static_cast<std::uint8_t>(
          static_cast<std::uint16_t>(t0 * c[i] + t1 * (b[i] + d[i]) + t2 * (a[i] + e[i]) + 128) >> 8);
    return;
  }
  for (int i = 0; i < length; ++i) {
    int sum = 128 + taps[0] * rows[radius][i];
    for (int k = 1; k <= radius; ++k)
      sum += taps[static_cast<std::size_t>(k)] * (rows[radius - k][i] + rows[radius + k][i]);
    line[i] = static_cast<std::uint8_t>(sum >> 8);
  }
}

// Horizontal pass over a line that has `radius` replicated pixels on either side; drops alpha.
RIGPROOF_VECTOR_CLONES
void blur_line(const std::uint8_t* line, int width, const std::vector<std::uint16_t>& taps, std::uint8_t* scratch,
               std::uint8_t* rgb) {
  const int radius = static_cast<int>(taps.size()) - 1, length = width * kChannels;
  const std::uint8_t* centre = line + radius * kChannels;
  if (radius == 2) {
    const std::uint16_t t0 = taps[0], t1 = taps[1], t2 = taps[2];
    for (int i = 0; i < length; ++i)
      scratch[i] =
          static_cast<std::uint8_t>(static_cast<std::uint16_t>(t0 * centre[i] + t1 * (centre[i - 4] + centre[i + 4]) +
                                                               t2 * (centre[i - 8] + centre[i + 8]) + 128) >>
                                    8);
  } else {
    for (int i = 0; i < length; ++i) {
      int sum = 128 + taps[0] * centre[i];
      for (int k = 1; k <= radius; ++k)
        sum += taps[static_cast<std::size_t>(k)] * (centre[i - k * kChannels] + centre[i + k * kChannels]);
      scratch[i] = static_cast<std::uint8_t>(sum >> 8);
    }
  }
  for (int x = 0; x < width; ++x)
    for (int c = 0; c < 3; ++c) rgb[3 * x + c] = scratch[kChannels * x + c];
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F)); }

}  // namespace

PointSpread::PointSpread(double sigma_px) {
  const std::vector<double> half = gaussian_half(sigma_px);
  int sum = 0;
  for (const double weight : half) taps_.push_back(static_cast<std::uint16_t>(std::lround(256.0 * weight)));
  while (taps_.size() > 1 && taps_.back() == 0) taps_.pop_back();
  for (std::size_t i = 1; i < taps_.size(); ++i) sum += 2 * taps_[i];
  taps_[0] = static_cast<std::uint16_t>(256 - sum);
}

void PointSpread::apply(const RgbaView& source, Image8* rgb) {
  const int radius = static_cast<int>(taps_.size()) - 1, width = source.width;
  resize(width, source.height, 3, rgb);
  const std::size_t length = static_cast<std::size_t>(width + 2 * radius) * kChannels;
  line_.resize(2 * length);
  std::uint8_t *line = line_.data(), *scratch = line + length;
  for (int y = 0; y < source.height; ++y) {
    std::uint8_t* first = line + radius * kChannels;
    blur_rows(source, y, taps_, first);
    for (int i = 1; i <= radius; ++i) {
      std::memcpy(first - i * kChannels, first, kChannels);
      std::memcpy(first + (width - 1 + i) * kChannels, first + (width - 1) * kChannels, kChannels);
    }
    blur_line(line, width, taps_, scratch, rgb->row(y));
  }
}

AreaReduction::AreaReduction(double sigma_px, int factor) : factor_(factor) {
  const std::vector<double> half = gaussian_half(factor * sigma_px);
  const int radius = static_cast<int>(half.size()) - 1, beside = factor / 2;
  // The sample j places out from the middle of the averaged ones gets the mean of the Gaussian seen from each of them.
  const auto gaussian = [&](int i) { return std::abs(i) > radius ? 0.0 : half[static_cast<std::size_t>(std::abs(i))]; };
  for (int j = 0; j < radius + beside; ++j) {
    double sum = 0.0;
    for (int i = -beside; i < beside; ++i) sum += gaussian(j - i);
    pair_weights_.push_back(static_cast<float>(sum / factor));
  }
  margin_px_ = (radius + factor - 1) / factor;
}

RIGPROOF_VECTOR_CLONES
void AreaReduction::apply(const RgbaView& source, const PixelRect& destination, Image8* rgb) {
  const int taps = static_cast<int>(pair_weights_.size());
  const int length = source.width * kChannels;
  line_.resize(static_cast<std::size_t>(length));
  float* line = line_.data();
  for (int y = 0; y < destination.height; ++y) {
    const int middle = factor_ * (y + margin_px_) + factor_ / 2 - 1;
    std::fill(line_.begin(), line_.end(), 0.0F);
    for (int j = 0; j < taps; ++j) {
      const std::uint8_t *above = source.row(middle - j), *below = source.row(middle + 1 + j);
      const float weight = pair_weights_[static_cast<std::size_t>(j)];
      for (int i = 0; i < length; ++i) line[i] += weight * static_cast<float>(above[i] + below[i]);
    }
    std::uint8_t* out = rgb->row(destination.y0 + y) + 3 * destination.x0;
    for (int x = 0; x < destination.width; ++x) {
      const float* centre = line + (factor_ * (x + margin_px_) + factor_ / 2 - 1) * kChannels;
      float sum[kChannels] = {0.5F, 0.5F, 0.5F, 0.5F};
      for (int j = 0; j < taps; ++j) {
        const float *left = centre - j * kChannels, *right = centre + (1 + j) * kChannels;
        const float weight = pair_weights_[static_cast<std::size_t>(j)];
        for (int c = 0; c < kChannels; ++c) sum[c] += weight * (left[c] + right[c]);
      }
      for (int c = 0; c < 3; ++c) out[3 * x + c] = to_byte(sum[c]);
    }
  }
}

RIGPROOF_VECTOR_CLONES
void sample_row(const RgbaView& source, const float* xs, const float* ys, int count, std::uint8_t* rgba) {
  // The last column and row have no neighbour to blend with.
  const float x_max = static_cast<float>(source.width) - 1.01F, y_max = static_cast<float>(source.height) - 1.01F;
  for (int i = 0; i < count; ++i, rgba += kChannels) {
    const float x = xs[i], y = ys[i];
    if (!(x >= 0.0F && y >= 0.0F && x <= x_max && y <= y_max)) {
      std::memset(rgba, 0, kChannels);
      continue;
    }
    const int fixed_x = static_cast<int>(x * 256.0F + 0.5F), fixed_y = static_cast<int>(y * 256.0F + 0.5F);
    const std::uint8_t* above = source.row(fixed_y >> 8) + (fixed_x >> 8) * kChannels;
    const std::uint8_t* below = above + source.stride;
    const int right = fixed_x & 255, left = 256 - right, bottom = fixed_y & 255, top = 256 - bottom;
    for (int c = 0; c < kChannels; ++c) {
      const int upper = left * above[c] + right * above[c + kChannels];
      const int lower = left * below[c] + right * below[c + kChannels];
      rgba[c] = static_cast<std::uint8_t>((top * upper + bottom * lower + (1 << 15)) >> 16);
    }
  }
}

}  // namespace rigproof
