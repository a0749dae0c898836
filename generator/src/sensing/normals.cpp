#include "normals.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

constexpr std::uint32_t kNormalMask = (1U << kNormalBits) - 1U;

double normal_density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * kPi); }
double normal_probability(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

RIGPROOF_VECTOR_CLONES
void blend(const float* const weights[4], const float* values, std::size_t count, float* out) {
  const float *w0 = weights[0], *w1 = weights[1], *w2 = weights[2], *w3 = weights[3];
  const float v0 = values[0], v1 = values[1], v2 = values[2], v3 = values[3];
  for (std::size_t i = 0; i < count; ++i) out[i] = w0[i] * v0 + w1[i] * v1 + w2[i] * v2 + w3[i] * v3;
}

}  // namespace

std::vector<float> normal_quantiles(int bits) {
  const std::size_t count = std::size_t{1} << bits;
  std::vector<float> quantiles(count);
  double x = 0.0;  // Newton's iteration from the neighbour's quantile; the lower half mirrors the upper
  for (std::size_t i = count / 2; i < count; ++i) {
    const double probability = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    for (int k = 0; k < 30; ++k) {
      const double step = (normal_probability(x) - probability) / normal_density(x);
      x -= step;
      if (std::abs(step) < 1e-10) break;
    }
    quantiles[i] = static_cast<float>(x);
    quantiles[count - 1 - i] = -quantiles[i];
  }
  return quantiles;
}

const std::vector<float>& normal_table() {
  static const std::vector<float> table = normal_quantiles(kNormalBits);
  return table;
}

CorrelatedNormals::CorrelatedNormals(int width, int side, RandomStream random)
    : width_(static_cast<std::size_t>(width)), side_(static_cast<std::size_t>(side)), random_(random) {
  if (width < 1 || side < 1) throw Error("correlated noise: width and side must be 1 or more");
  words_.resize((width_ + side_) / 2);
  white_.resize(2 * words_.size());
  out_.resize(width_);
  ring_.resize(width_ * side_);
  for (std::size_t i = 1; i < side_; ++i) add_sums();
}

// White noise, and its moving sums over `side` pixels along x, which have the variance `side`.
void CorrelatedNormals::add_sums() {
  const float* normals = normal_table().data();
  random_.fill(words_.data(), words_.size());
  for (std::size_t i = 0; i < words_.size(); ++i) {
    white_[2 * i] = normals[words_[i] & kNormalMask];
    white_[2 * i + 1] = normals[words_[i] >> (32 - kNormalBits)];
  }
  float* sums = ring_.data() + oldest_ * width_;
  std::copy_n(white_.data(), width_, sums);
  for (std::size_t k = 1; k < side_; ++k) {
    for (std::size_t x = 0; x < width_; ++x) sums[x] += white_[x + k];
  }
  oldest_ = (oldest_ + 1) % side_;
}

// The total of the ring has the variance side^2. It is built anew for every row: a running difference would let
// rounding errors grow down the image.
const float* CorrelatedNormals::next_row() {
  add_sums();
  std::copy_n(ring_.data(), width_, out_.data());
  for (std::size_t k = 1; k < side_; ++k) {
    const float* sums = ring_.data() + k * width_;
    for (std::size_t x = 0; x < width_; ++x) out_[x] += sums[x];
  }
  const float scale = 1.0F / static_cast<float>(side_);
  for (float& value : out_) value *= scale;
  return out_.data();
}

SmoothField::SmoothField(int width, int height, double cell_px, RandomStream random) {
  if (width < 1 || height < 1 || !(cell_px >= 1.0))
    throw Error("smooth field: sizes and cells must be at least a pixel");
  across_ = taps_of(width, cell_px);
  down_ = taps_of(height, cell_px);
  columns_ = across_.first.back() + 4;
  lattice_.resize(columns_ * (down_.first.back() + 4));
  for (float& value : lattice_) value = static_cast<float>(random.normal());
}

SmoothField::Taps SmoothField::taps_of(int size, double cell_px) {
  Taps taps;
  for (int pixel = 0; pixel < size; ++pixel) {
    const double place = pixel / cell_px, t = place - std::floor(place);
    const double spline[4] = {(1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                              (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0, t * t * t / 6.0};
    double squares = 0.0;
    for (const double weight : spline) squares += weight * weight;
    taps.first.push_back(static_cast<std::size_t>(place));
    for (std::size_t k = 0; k < 4; ++k) taps.weight[k].push_back(static_cast<float>(spline[k] / std::sqrt(squares)));
  }
  return taps;
}

void SmoothField::row(int y, float* out) const {
  const auto row = static_cast<std::size_t>(y);
  std::vector<float> line(columns_, 0.0F);
  for (std::size_t k = 0; k < 4; ++k) {
    const float* lattice = lattice_.data() + (down_.first[row] + k) * columns_;
    for (std::size_t i = 0; i < columns_; ++i) line[i] += down_.weight[k][row] * lattice[i];
  }
  // Pixels of one cell have the same neighbours.
  const std::size_t width = across_.first.size();
  for (std::size_t x = 0; x < width;) {
    const std::size_t first = across_.first[x];
    std::size_t end = x + 1;
    while (end < width && across_.first[end] == first) ++end;
    const float* weights[4] = {&across_.weight[0][x], &across_.weight[1][x], &across_.weight[2][x],
                               &across_.weight[3][x]};
    blend(weights, line.data() + first, end - x, out + x);
    x = end;
  }
}

}  // namespace rigproof
