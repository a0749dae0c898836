// Fixed gain and offset of every pixel of a device (PRNU, DSNU; EMVA 1288).
#include <cmath>

#include "../sensing/normals.h"
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

constexpr int kMapBits = 8;
constexpr std::size_t kChannels = 3;

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

class PixelPattern final : public ClonedEffect<ImageEffect, PixelPattern> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("pixel_pattern", on_, "fixed gain and offset of every pixel of the device (PRNU, DSNU)");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("dark_offset_electrons", offset_electrons_, {0.0, 1000.0},
                  "fixed offset of each pixel (DSNU), one sigma");
    visitor.field("pixel_gain_percent", gain_percent_, {0.0, 20.0}, "fixed gain error of each pixel (PRNU), one sigma");
  }
  bool resolve(DeviceDraws* /*draws*/) override {
    gain_ = gain_percent_ / 100.0;
    return on_ && (offset_electrons_ > 0.0 || gain_ > 0.0);
  }
  void label(Labels* labels) const override {
    if (offset_electrons_ > 0.0) (*labels)["pixel_offset_electrons"] = offset_electrons_;
    if (gain_ > 0.0) (*labels)["pixel_gain_percent"] = 100.0 * gain_;
  }
  void prepare(int width, int height, const FrameSeed& device) override {
    const std::size_t samples = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kChannels;
    gain_of_draw_ = map_values(gain_, 1.0);
    offset_of_draw_ = map_values(offset_electrons_, 0.0);
    if (gain_ > 0.0) gain_draws_ = random_bytes(samples, device.stream("pixel gain"));
    if (offset_electrons_ > 0.0) offset_draws_ = random_bytes(samples, device.stream("pixel offset"));
  }
  void change_electrons(int y, std::size_t samples, float* electrons) const override {
    const std::size_t first = static_cast<std::size_t>(y) * samples;
    if (!gain_draws_.empty())
      for (std::size_t i = 0; i < samples; ++i) electrons[i] *= gain_of_draw_[gain_draws_[first + i]];
    if (!offset_draws_.empty())
      for (std::size_t i = 0; i < samples; ++i) electrons[i] += offset_of_draw_[offset_draws_[first + i]];
  }
  double pedestal_electrons() const override { return 4.0 * offset_electrons_; }

 private:
  bool on_ = true;
  double offset_electrons_ = 1.0, gain_percent_ = 0.8, gain_ = 0.0;
  std::vector<std::uint8_t> gain_draws_, offset_draws_;  ///< a random byte for every sample
  std::vector<float> gain_of_draw_, offset_of_draw_;
};

}  // namespace

std::unique_ptr<ImageEffect> pixel_pattern_effect() { return std::make_unique<PixelPattern>(); }

}  // namespace rigproof
