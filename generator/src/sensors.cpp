#include "rigproof/generator/sensors.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// One random word serves the three colours of a pixel with ten bits each: noise is cut off at 3.3 sigma and its
// variance is 0.3 % too small, an order below what 8-bit rounding does.
constexpr int kColorBits = 10;
constexpr std::uint32_t kColorMask = (1U << kColorBits) - 1U;
// Depth noise is drawn with twelve bits, cut off at 3.7 sigma before the moving average; the table stays in the cache.
constexpr int kDepthBits = 12;
constexpr std::uint32_t kDepthMask = (1U << kDepthBits) - 1U;

double normal_density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * kPi); }
double normal_probability(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// Level that a pixel of the clean level shows with the given standard normal number.
std::uint8_t noisy_level(int level, double normal, const ImageNoise& noise) {
  const double electrons = noise.full_well_electrons * std::pow(level / 255.0, noise.gamma);
  const double sigma = std::sqrt(electrons + noise.read_noise_electrons * noise.read_noise_electrons);
  const double light = std::clamp((electrons + sigma * normal) / noise.full_well_electrons, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255.0 * std::pow(light, 1.0 / noise.gamma)));
}

std::vector<std::uint8_t> noise_table(const ImageNoise& noise) {
  const std::vector<float> normals = normal_quantiles(kColorBits);
  std::vector<std::uint8_t> table;
  table.reserve(256 * normals.size());
  for (int level = 0; level < 256; ++level) {
    for (const float normal : normals) table.push_back(noisy_level(level, static_cast<double>(normal), noise));
  }
  return table;
}

const std::vector<float>& depth_quantiles() {
  static const std::vector<float> table = normal_quantiles(kDepthBits);
  return table;
}

// Everything that the loop over pixels needs, in single precision.
struct StereoConstants {
  float disparity_m;  ///< focal length times baseline: disparity [px] = disparity_m / z
  float sigma_px;
  float steps, per_step;
  float scale_over_unit;
  float min_m, max_m;
};

// Far beyond any stereo camera's, small enough to count its steps in an int.
constexpr float kMaxDisparityPx = 1e5F;

// No branches in the two functions below, so that the loop over pixels becomes vector code.
std::uint16_t rounded_count(float measured_m, std::int32_t valid, float scale_over_unit, float min_m, float max_m) {
  const float within = std::min(measured_m, 2.0F * max_m);
  const std::int32_t good =
      valid & static_cast<std::int32_t>(within >= min_m) & static_cast<std::int32_t>(within <= max_m);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(within * scale_over_unit + 0.5F) * good);
}

std::uint16_t stereo_count(float z_m, float normal, const StereoConstants& c) {
  // A pixel without depth divides by one instead of zero, and is marked invalid.
  const float ideal = std::min(c.disparity_m / (z_m > 0.0F ? z_m : 1.0F), kMaxDisparityPx);
  const float disparity = ideal + c.sigma_px * normal;
  // Disparities are positive where they matter, so that truncation after adding a half rounds.
  const float rounded = static_cast<float>(static_cast<std::int32_t>(disparity * c.steps + 0.5F)) * c.per_step;
  const std::int32_t valid = static_cast<std::int32_t>(z_m > 0.0F) & static_cast<std::int32_t>(rounded > 0.0F);
  const float measured_m = c.disparity_m / (rounded > 0.0F ? rounded : 1.0F);
  return rounded_count(measured_m, valid, c.scale_over_unit, c.min_m, c.max_m);
}

struct FlightConstants {
  float constant_m, proportional;
  float scale_over_unit;
  float min_m, max_m;
};

std::uint16_t flight_count(float z_m, float normal, const FlightConstants& c) {
  const float measured_m = z_m + (c.constant_m + c.proportional * z_m) * normal;
  return rounded_count(measured_m, static_cast<std::int32_t>(z_m > 0.0F), c.scale_over_unit, c.min_m, c.max_m);
}

// The largest depth that the 16-bit image can hold bounds the range as well.
float farthest_m(const DepthSensing& depth, double scale) {
  return static_cast<float>(std::min(depth.stream.max_m, 65534.0 * depth.stream.unit_m / scale));
}

StereoConstants stereo_constants(const DepthSensing& depth, double scale) {
  const float steps = static_cast<float>(depth.disparity_steps_per_px);
  return {static_cast<float>(depth.disparity_sigma_px / depth.stream.noise.inverse_depth_sigma_per_m),
          static_cast<float>(depth.disparity_sigma_px),
          steps,
          1.0F / steps,
          static_cast<float>(scale / depth.stream.unit_m),
          static_cast<float>(depth.stream.min_m),
          farthest_m(depth, scale)};
}

FlightConstants flight_constants(const DepthSensing& depth, double scale) {
  return {static_cast<float>(depth.stream.noise.constant_m), static_cast<float>(depth.stream.noise.proportional),
          static_cast<float>(scale / depth.stream.unit_m), static_cast<float>(depth.stream.min_m),
          farthest_m(depth, scale)};
}

template <typename Count>
void sense_rows(const ImageF& depth_m, CorrelatedNormals* normals, Image16* counts, const Count& count) {
  for (int y = 0; y < depth_m.height; ++y) {
    const float* noise = normals->next_row();
    const float* depth = depth_m.row(y);
    std::uint16_t* out = counts->row(y);
    const std::size_t width = depth_m.row_length();
    for (std::size_t x = 0; x < width; ++x) out[x] = count(depth[x], noise[x]);
  }
}

RIGPROOF_VECTOR_CLONES
void round_to_unit(const ImageF& depth_m, double unit_m, double scale, Image16* counts) {
  const float per_unit = static_cast<float>(scale / unit_m);
  for (std::size_t i = 0; i < depth_m.pixels.size(); ++i) {
    const float count = depth_m.pixels[i] * per_unit + 0.5F;
    counts->pixels[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(count < 65536.0F ? count : 0.0F));
  }
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
  const float* normals = depth_quantiles().data();
  random_.fill(words_.data(), words_.size());
  for (std::size_t i = 0; i < words_.size(); ++i) {
    white_[2 * i] = normals[words_[i] & kDepthMask];
    white_[2 * i + 1] = normals[words_[i] >> (32 - kDepthBits)];
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

Sensor::Sensor(const SensorModel& model) : model_(model) {
  if (model_.image_noise) noisy_levels_ = noise_table(*model_.image_noise);
  if (model_.depth_noise) depth_quantiles();  // before any fork, so that processes share it
}

void Sensor::sense_color(RandomStream random, Image8* image) const {
  if (!model_.image_noise) return;
  const std::size_t count = image->pixels.size();
  std::vector<std::uint32_t> words((image->row_length() + 2) / 3);
  std::uint8_t* pixel = image->pixels.data();
  std::uint8_t* const end = pixel + count;
  while (pixel < end) {
    random.fill(words.data(), words.size());
    for (const std::uint32_t word : words) {
      for (int c = 0; c < 3 && pixel < end; ++c, ++pixel) {
        const std::uint32_t draw = (word >> (kColorBits * c)) & kColorMask;
        *pixel = noisy_levels_[(std::size_t{*pixel} << kColorBits) + draw];
      }
    }
  }
}

void Sensor::sense_depth(const ImageF& depth_m, double unit_m, RandomStream random, Image16* counts) const {
  if (counts->width != depth_m.width || counts->height != depth_m.height) {
    *counts = Image16(depth_m.width, depth_m.height);
  }
  if (!model_.depth_noise) return round_to_unit(depth_m, unit_m, model_.depth_scale, counts);
  const DepthSensing& depth = *model_.depth_noise;
  const int side = std::max(1, static_cast<int>(std::lround(depth.stream.noise.correlation_px)));
  CorrelatedNormals normals(depth_m.width, side, random);
  if (depth.stream.noise.law == DepthNoise::Law::kStereo) {
    const StereoConstants constants = stereo_constants(depth, model_.depth_scale);
    sense_rows(depth_m, &normals, counts, [&](float z_m, float n) { return stereo_count(z_m, n, constants); });
  } else {
    const FlightConstants constants = flight_constants(depth, model_.depth_scale);
    sense_rows(depth_m, &normals, counts, [&](float z_m, float n) { return flight_count(z_m, n, constants); });
  }
}

}  // namespace rigproof
