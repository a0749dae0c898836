#include "rigproof/generator/sensors.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// One random word serves the three colours of a pixel with ten bits each: noise is cut off at 3.3 sigma and its
// variance is 0.3 % too small, an order below what 8-bit rounding does.
constexpr int kColorBits = 10;
constexpr std::uint32_t kColorMask = (1U << kColorBits) - 1U;
// Depth noise is drawn with sixteen bits: cut off at 4.3 sigma.
constexpr int kDepthBits = 16;

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

// White noise, then moving sums over `side` pixels along x; each sum has the variance `side`.
void horizontal_sums(int width, int side, const std::vector<float>& normals, RandomStream* random,
                     std::vector<std::uint32_t>* words, std::vector<float>* row, float* out) {
  const std::size_t count = static_cast<std::size_t>(width + side - 1);
  words->resize((count + 1) / 2);
  row->resize(2 * words->size());
  random->fill(words->data(), words->size());
  for (std::size_t i = 0; i < words->size(); ++i) {
    (*row)[2 * i] = normals[(*words)[i] & 0xFFFFU];
    (*row)[2 * i + 1] = normals[(*words)[i] >> 16U];
  }
  for (int x = 0; x < width; ++x) out[x] = (*row)[static_cast<std::size_t>(x)];
  for (int k = 1; k < side; ++k) {
    const float* shifted = row->data() + k;
    for (int x = 0; x < width; ++x) out[x] += shifted[x];
  }
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

std::uint16_t stereo_count(float z_m, float normal, const StereoConstants& c) {
  // A pixel without depth divides by one instead of zero, and is marked invalid below.
  const float ideal = std::min(c.disparity_m / (z_m > 0.0F ? z_m : 1.0F), kMaxDisparityPx);
  const float disparity = ideal + c.sigma_px * normal;
  // Disparities are positive where they matter, so that truncation after adding a half rounds.
  const float rounded = static_cast<float>(static_cast<std::int32_t>(disparity * c.steps + 0.5F)) * c.per_step;
  const float measured_m = c.disparity_m / rounded;
  const bool valid = z_m > 0.0F && rounded > 0.0F && measured_m >= c.min_m && measured_m <= c.max_m;
  const float count = valid ? measured_m * c.scale_over_unit + 0.5F : 0.0F;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(count));
}

struct FlightConstants {
  float constant_m, proportional;
  float scale_over_unit;
  float min_m, max_m;
};

std::uint16_t flight_count(float z_m, float normal, const FlightConstants& c) {
  const float measured_m = z_m + (c.constant_m + c.proportional * z_m) * normal;
  const bool valid = z_m > 0.0F && measured_m >= c.min_m && measured_m <= c.max_m;
  const float count = valid ? measured_m * c.scale_over_unit + 0.5F : 0.0F;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(count));
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

void correlated_normals(int width, int height, int side, RandomStream random, std::vector<float>* field) {
  if (side < 1) throw Error("correlation of depth noise: " + std::to_string(side) + " px; must be 1 or more");
  const std::vector<float>& normals = depth_quantiles();
  const std::size_t w = static_cast<std::size_t>(width);
  field->resize(w * static_cast<std::size_t>(height));
  // A ring of the last `side` rows of horizontal sums; `sums` is their total, which has the variance side^2. The total
  // is built anew for each row: a running difference would let rounding errors grow down the image.
  std::vector<float> ring(w * static_cast<std::size_t>(side)), row;
  std::vector<std::uint32_t> words;
  const float scale = 1.0F / static_cast<float>(side);
  for (int y = 0; y < height + side - 1; ++y) {
    horizontal_sums(width, side, normals, &random, &words, &row, ring.data() + w * static_cast<std::size_t>(y % side));
    if (y < side - 1) continue;
    float* out = field->data() + w * static_cast<std::size_t>(y - side + 1);
    std::copy_n(ring.data(), w, out);
    for (int k = 1; k < side; ++k) {
      const float* sums = ring.data() + w * static_cast<std::size_t>(k);
      for (std::size_t x = 0; x < w; ++x) out[x] += sums[x];
    }
    for (std::size_t x = 0; x < w; ++x) out[x] *= scale;
  }
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
  std::vector<float> normals;
  correlated_normals(depth_m.width, depth_m.height, side, random, &normals);
  const std::size_t count = depth_m.pixels.size();
  if (depth.stream.noise.law == DepthNoise::Law::kStereo) {
    const StereoConstants constants = stereo_constants(depth, model_.depth_scale);
    for (std::size_t i = 0; i < count; ++i) {
      counts->pixels[i] = stereo_count(depth_m.pixels[i], normals[i], constants);
    }
  } else {
    const FlightConstants constants = flight_constants(depth, model_.depth_scale);
    for (std::size_t i = 0; i < count; ++i) {
      counts->pixels[i] = flight_count(depth_m.pixels[i], normals[i], constants);
    }
  }
}

}  // namespace rigproof
