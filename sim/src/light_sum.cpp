#include "light_sum.h"

#include <algorithm>
#include <cmath>

#include "resample.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// Level 1 of 255 with a gamma of 3 still has an entry of its own.
constexpr int kRoots = 1 << 14;

RIGPROOF_VECTOR_CLONES
void add_light(const std::uint8_t* levels, std::size_t count, float share, const float* light_of_level, float* light) {
  for (std::size_t i = 0; i < count; ++i) light[i] += share * light_of_level[levels[i]];
}

}  // namespace

LightSum::LightSum(int width, int height, int channels, double gamma)
    : width_(width), height_(height), channels_(channels), light_of_level_(256), level_of_root_(kRoots + 1) {
  for (std::size_t level = 0; level < 256; ++level)
    light_of_level_[level] = static_cast<float>(std::pow(static_cast<double>(level) / 255.0, gamma));
  for (int i = 0; i <= kRoots; ++i) {
    const double root = static_cast<double>(i) / kRoots;
    level_of_root_[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::pow(root, 2.0 / gamma)));
  }
  light_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels),
                0.0F);
}

void LightSum::add_row(int row, double share, const std::uint8_t* levels) {
  const std::size_t length = static_cast<std::size_t>(width_) * static_cast<std::size_t>(channels_);
  add_light(levels, length, static_cast<float>(share), light_of_level_.data(),
            light_.data() + static_cast<std::size_t>(row) * length);
}

void LightSum::write(Image8* image) const {
  resize(width_, height_, channels_, image);
  for (std::size_t i = 0; i < light_.size(); ++i) {
    const float root = std::sqrt(std::clamp(light_[i], 0.0F, 1.0F));
    image->pixels[i] = level_of_root_[static_cast<std::size_t>(root * static_cast<float>(kRoots) + 0.5F)];
  }
}

}  // namespace rigproof
