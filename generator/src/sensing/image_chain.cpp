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

RIGPROOF_VECTOR_CLONES
void roots_of(const float* electrons, std::size_t count, float pedestal, float steps_per_root, std::int32_t* roots) {
  constexpr float kLast = kRootSteps - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float above = electrons[i] + pedestal;
    const float root = steps_per_root * std::sqrt(above > 0.0F ? above : 0.0F) + 0.5F;
    roots[i] = static_cast<std::int32_t>(root < kLast ? root : kLast);
  }
}

// The image in electrons after the effects that want all of it; empty if there are none.
ImageF changed_image(const EffectList<ImageEffect>& effects, const std::vector<float>& electrons_of_level,
                     const Image8& image) {
  ImageF changed;
  for (const auto& effect : effects) {
    if (!effect->changes_image()) continue;
    if (changed.empty()) {
      changed = ImageF(image.width, image.height, 3);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) changed.pixels[i] = electrons_of_level[image.pixels[i]];
    }
    effect->change_image(&changed);
  }
  return changed;
}

// Light of a row through the effects. @param light scratch memory for a number a pixel
void expose_row(const EffectList<ImageEffect>& effects, int y, float exposure, std::vector<float>* light,
                std::vector<float>* electrons) {
  std::fill(light->begin(), light->end(), exposure);
  for (const auto& effect : effects) effect->change_light(y, light->size(), light->data());
  for (std::size_t x = 0, i = 0; x < light->size(); ++x)
    for (int c = 0; c < 3; ++c, ++i) (*electrons)[i] *= (*light)[x];
  for (const auto& effect : effects) effect->change_electrons(y, electrons->size(), electrons->data());
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

ImageChain::ImageChain(const ImageSensing& model) {
  for (int level = 0; level < 256; ++level)
    electrons_of_level_.push_back(static_cast<float>(electrons_at(level, model)));
  const std::vector<float> normals = normal_quantiles(kColorBits);
  const LevelCoder coder(model);
  double pedestal = 0.0;
  for (const auto& effect : model.effects) pedestal += effect->pedestal_electrons();
  const double steps_per_root = (kRootSteps - 1) / std::sqrt(kHeadroom * model.full_well_electrons + pedestal);
  pedestal_ = static_cast<float>(pedestal);
  steps_per_root_ = static_cast<float>(steps_per_root);
  coded_.reserve(static_cast<std::size_t>(kRootSteps) * normals.size());
  for (int root = 0; root < kRootSteps; ++root) {
    const double electrons = std::pow(root / steps_per_root, 2) - pedestal;
    coder.append_levels(electrons, noise_sigma(electrons, model), normals, &coded_);
  }
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

void ImageChain::apply(const ImageSensing& model, const FrameSeed& frame, Image8* image) const {
  RandomStream noise = frame.stream("image noise");
  double exposure = 1.0;
  for (const auto& effect : model.effects) exposure *= effect->light_of_frame(frame);
  const ImageF changed = changed_image(model.effects, electrons_of_level_, *image);
  std::vector<float> electrons(image->row_length());
  std::vector<float> light(static_cast<std::size_t>(image->width));
  std::vector<std::uint32_t> words(light.size());
  std::vector<std::int32_t> roots(electrons.size());
  for (int y = 0; y < image->height; ++y) {
    std::uint8_t* row = image->row(y);
    if (changed.empty())
      for (std::size_t i = 0; i < electrons.size(); ++i) electrons[i] = electrons_of_level_[row[i]];
    else
      std::copy_n(changed.row(y), electrons.size(), electrons.data());
    expose_row(model.effects, y, static_cast<float>(exposure), &light, &electrons);
    noise.fill(words.data(), words.size());
    code_row(electrons.data(), words.data(), electrons.size(), roots.data(), row);
  }
  for (const auto& effect : model.effects) effect->change_levels(image);
}

}  // namespace rigproof
