#include "image_chain.h"

#include <algorithm>
#include <cmath>

#include "normals.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// One random word serves the three colours of a pixel with ten bits each: noise is cut off at 3.3 sigma and its
// variance is 0.3 % too small, an order below what 8-bit rounding does.
constexpr int kColorBits = 10;
constexpr std::uint32_t kColorMask = (1U << kColorBits) - 1U;
constexpr int kMapBits = 8;
// Steps of the root of the electrons. Shot noise is half an electron's root everywhere, so that even for a full well of
// 6300 a step is a thirteenth of it: 0.05 % of the variance.
constexpr int kRootSteps = 2048;
// The table reaches this much further than a full well; beyond, everything is white even in the noise's lower tail.
constexpr double kHeadroom = 1.3;

// Levels of light, gamma coded and rounded. Tables ask for rising light, so that looking for the next level's lower end
// saves a power for each of their millions of entries.
class LevelCoder {
 public:
  explicit LevelCoder(const ImageSensing& model) {
    for (int level = 1; level < 256; ++level)
      lower_end_.push_back(model.full_well_electrons * std::pow((level - 0.5) / 255.0, model.gamma));
  }
  /// Electrons + sigma * normal for each of the normals, which rise.
  void append_levels(double electrons, double sigma, const std::vector<float>& normals,
                     std::vector<std::uint8_t>* levels) const {
    const auto light = [&](std::size_t i) { return electrons + sigma * static_cast<double>(normals[i]); };
    auto next = std::upper_bound(lower_end_.begin(), lower_end_.end(), light(0));
    for (std::size_t i = 0; i < normals.size(); ++i) {
      while (next != lower_end_.end() && *next <= light(i)) ++next;
      levels->push_back(static_cast<std::uint8_t>(next - lower_end_.begin()));
    }
  }

 private:
  std::vector<double> lower_end_;  ///< of levels 1, 2, .. 255 [electrons]
};

double electrons_at(int level, const ImageSensing& model) {
  return model.full_well_electrons * std::pow(level / 255.0, model.gamma);
}

double noise_sigma(double electrons, const ImageSensing& model) {
  if (!model.noise) return 0.0;
  return std::sqrt(std::max(electrons, 0.0) + model.read_noise_electrons * model.read_noise_electrons);
}

// Normal numbers of a byte, stretched to make up for their missing tails.
std::vector<float> map_values(double sigma, double mean) {
  std::vector<float> values = normal_quantiles(kMapBits);
  double squares = 0.0;
  for (const float value : values) squares += static_cast<double>(value) * static_cast<double>(value);
  const double stretch = sigma / std::sqrt(squares / static_cast<double>(values.size()));
  for (float& value : values) value = static_cast<float>(mean + stretch * static_cast<double>(value));
  return values;
}

std::vector<std::uint8_t> random_bytes(std::size_t count, RandomStream random) {
  std::vector<std::uint32_t> words((count + 3) / 4);
  random.fill(words.data(), words.size());
  std::vector<std::uint8_t> bytes(4 * words.size());
  for (std::size_t i = 0; i < words.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) bytes[4 * i + k] = static_cast<std::uint8_t>(words[i] >> (8 * k));
  return bytes;
}

RIGPROOF_VECTOR_CLONES
void roots_of(const float* electrons, std::size_t count, float pedestal, float steps_per_root, std::int32_t* roots) {
  constexpr float kLast = kRootSteps - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float above = electrons[i] + pedestal;
    const float root = steps_per_root * std::sqrt(above > 0.0F ? above : 0.0F) + 0.5F;
    roots[i] = static_cast<std::int32_t>(root < kLast ? root : kLast);
  }
}

// Light of a row of pixels over that of the render.
RIGPROOF_VECTOR_CLONES
void light_of_row(float exposure, float falloff, float y2, float x_first, float x_step, std::size_t pixels,
                  float* light) {
  for (std::size_t x = 0; x < pixels; ++x) {
    const float across = x_first + x_step * static_cast<float>(x);
    const float loss = 1.0F + falloff * (across * across + y2);
    light[x] = exposure / (loss * loss);
  }
}

// Calls change(electrons, i) for every sample of a row after its pixel's light.
template <typename Change>
void expose_samples(const float* light, std::size_t pixels, const Change& change, float* electrons) {
  for (std::size_t x = 0, i = 0; x < pixels; ++x)
    for (int c = 0; c < 3; ++c, ++i) electrons[i] = change(electrons[i] * light[x], i);
}

std::vector<float> gaussian_taps(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma_px));
  std::vector<float> taps;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma_px * sigma_px));
  for (int i = -reach; i <= reach; ++i)
    taps.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px)) / sum));
  return taps;
}

RIGPROOF_VECTOR_CLONES
void add_weighted(const float* in, float weight, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

}  // namespace

LevelNoise::LevelNoise(const ImageSensing& model) {
  const std::vector<float> normals = normal_quantiles(kColorBits);
  const LevelCoder coder(model);
  levels_.reserve(256 * normals.size());
  for (int level = 0; level < 256; ++level) {
    const double electrons = electrons_at(level, model);
    coder.append_levels(electrons, noise_sigma(electrons, model), normals, &levels_);
  }
}

void LevelNoise::apply(RandomStream random, Image8* image) const {
  std::vector<std::uint32_t> words((image->row_length() + 2) / 3);
  std::uint8_t* pixel = image->pixels.data();
  std::uint8_t* const end = pixel + image->pixels.size();
  while (pixel < end) {
    random.fill(words.data(), words.size());
    for (const std::uint32_t word : words) {
      for (int c = 0; c < 3 && pixel < end; ++c, ++pixel) {
        const std::uint32_t draw = (word >> (kColorBits * c)) & kColorMask;
        *pixel = levels_[(std::size_t{*pixel} << kColorBits) + draw];
      }
    }
  }
}

ImageChain::ImageChain(const ImageSensing& model, int width, int height, const FrameSeed& device)
    : model_(model), width_(width), height_(height) {
  falloff_ = static_cast<float>(1.0 / std::sqrt(model.corner_light) - 1.0);
  for (int level = 0; level < 256; ++level)
    electrons_of_level_.push_back(static_cast<float>(electrons_at(level, model)));
  constexpr std::size_t kMostChannels = 3;
  make_pixel_tables(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kMostChannels, device);
  make_coding_table();
}

void ImageChain::make_pixel_tables(std::size_t samples, const FrameSeed& device) {
  const FrameSeed fixed{device.seed, -1, device.camera};
  gain_of_draw_ = map_values(model_.pixel_gain, 1.0);
  offset_of_draw_ = map_values(model_.dark_offset_electrons, 0.0);
  if (model_.pixel_gain > 0.0) gain_draws_ = random_bytes(samples, fixed.stream("pixel gain"));
  if (model_.dark_offset_electrons > 0.0) offset_draws_ = random_bytes(samples, fixed.stream("pixel offset"));
}

void ImageChain::make_coding_table() {
  const std::vector<float> normals = normal_quantiles(kColorBits);
  const LevelCoder coder(model_);
  // Offsets may leave less than nothing.
  const double pedestal = 4.0 * model_.dark_offset_electrons;
  const double steps_per_root = (kRootSteps - 1) / std::sqrt(kHeadroom * model_.full_well_electrons + pedestal);
  pedestal_ = static_cast<float>(pedestal);
  steps_per_root_ = static_cast<float>(steps_per_root);
  coded_.reserve(static_cast<std::size_t>(kRootSteps) * normals.size());
  for (int root = 0; root < kRootSteps; ++root) {
    const double electrons = std::pow(root / steps_per_root, 2) - pedestal;
    coder.append_levels(electrons, noise_sigma(electrons, model_), normals, &coded_);
  }
}

// Light of a row, dimmed by lens and exposure, through the pixels' own gains and offsets.
void ImageChain::expose_row(int y, float exposure, float* light, float* electrons) const {
  const std::size_t samples = static_cast<std::size_t>(width_) * 3;
  const float half_x = 0.5F * static_cast<float>(width_ - 1), half_y = 0.5F * static_cast<float>(height_ - 1);
  const float corner = std::sqrt(half_x * half_x + half_y * half_y);
  const float v = (static_cast<float>(y) - half_y) / corner;
  const auto pixels = static_cast<std::size_t>(width_);
  light_of_row(exposure, falloff_, v * v, -half_x / corner, 1.0F / corner, pixels, light);
  const std::size_t first = static_cast<std::size_t>(y) * samples;
  const std::uint8_t* gains = gain_draws_.empty() ? nullptr : gain_draws_.data() + first;
  const std::uint8_t* offsets = offset_draws_.empty() ? nullptr : offset_draws_.data() + first;
  const float *gain_of = gain_of_draw_.data(), *offset_of = offset_of_draw_.data();
  const auto with_gain = [=](float e, std::size_t i) { return e * gain_of[gains[i]]; };
  const auto with_offset = [=](float e, std::size_t i) { return e + offset_of[offsets[i]]; };
  const auto with_both = [=](float e, std::size_t i) { return with_offset(with_gain(e, i), i); };
  if (gains != nullptr && offsets != nullptr)
    expose_samples(light, pixels, with_both, electrons);
  else if (gains != nullptr)
    expose_samples(light, pixels, with_gain, electrons);
  else if (offsets != nullptr)
    expose_samples(light, pixels, with_offset, electrons);
  else
    expose_samples(
        light, pixels, [](float e, std::size_t) { return e; }, electrons);
}

void ImageChain::code_row(const float* electrons, const std::uint32_t* words, std::size_t count, std::int32_t* roots,
                          std::uint8_t* out) const {
  roots_of(electrons, count, pedestal_, steps_per_root_, roots);
  for (std::size_t i = 0; i + 2 < count; i += 3, ++words) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t draw = (*words >> (kColorBits * c)) & kColorMask;
      out[i + c] = coded_[(static_cast<std::size_t>(roots[i + c]) << kColorBits) + draw];
    }
  }
}

void ImageChain::apply(const FrameSeed& frame, Image8* image) const {
  RandomStream noise = frame.stream("image noise");
  const double jitter = model_.exposure_jitter > 0.0 ? frame.stream("exposure").normal() * model_.exposure_jitter : 0.0;
  const auto exposure = static_cast<float>(model_.exposure * std::max(0.01, 1.0 + jitter));
  ImageF blurred;
  if (model_.defocus_sigma_px > 0.0) {
    blurred = ImageF(image->width, image->height, 3);
    for (std::size_t i = 0; i < image->pixels.size(); ++i) blurred.pixels[i] = electrons_of_level_[image->pixels[i]];
    blur_samples(model_.defocus_sigma_px, &blurred);
  }
  std::vector<float> electrons(image->row_length());
  std::vector<float> light(static_cast<std::size_t>(image->width));
  std::vector<std::uint32_t> words(light.size());
  std::vector<std::int32_t> roots(electrons.size());
  for (int y = 0; y < image->height; ++y) {
    std::uint8_t* row = image->row(y);
    if (blurred.empty())
      for (std::size_t i = 0; i < electrons.size(); ++i) electrons[i] = electrons_of_level_[row[i]];
    else
      std::copy_n(blurred.row(y), electrons.size(), electrons.data());
    expose_row(y, exposure, light.data(), electrons.data());
    noise.fill(words.data(), words.size());
    code_row(electrons.data(), words.data(), electrons.size(), roots.data(), row);
  }
}

void blur_samples(double sigma_px, ImageF* image) {
  const std::vector<float> taps = gaussian_taps(sigma_px);
  const int reach = static_cast<int>(taps.size() / 2), channels = image->channels;
  const std::size_t length = image->row_length();
  ImageF across(image->width, image->height, channels);
  std::vector<float> padded(length + 2 * static_cast<std::size_t>(reach * channels));
  for (int y = 0; y < image->height; ++y) {
    const float* row = image->row(y);
    float* middle = padded.data() + reach * channels;
    std::copy_n(row, length, middle);
    for (int i = 1; i <= reach; ++i) {
      std::copy_n(row, channels, middle - i * channels);
      std::copy_n(row + length - static_cast<std::size_t>(channels), channels,
                  middle + length + static_cast<std::size_t>((i - 1) * channels));
    }
    for (int i = -reach; i <= reach; ++i)
      add_weighted(middle + i * channels, taps[static_cast<std::size_t>(i + reach)], length, across.row(y));
  }
  for (int y = 0; y < image->height; ++y) {
    float* row = image->row(y);
    std::fill_n(row, length, 0.0F);
    for (int i = -reach; i <= reach; ++i)
      add_weighted(across.row(std::clamp(y + i, 0, image->height - 1)), taps[static_cast<std::size_t>(i + reach)],
                   length, row);
  }
}

}  // namespace rigproof
