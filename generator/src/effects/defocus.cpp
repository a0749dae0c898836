// Gaussian blur of the light beside the lens's own.
#include <cmath>

#include "rigproof/core/vector_clones.h"
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

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

// Of interleaved channels; edges are replicated.
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

class Defocus final : public ClonedEffect<ImageEffect, Defocus> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("defocus_sigma_px", drawn_px_, {0.0, 10.0},
                  "blur beside the lens's own, drawn for each camera; render.psf_sigma_px is the lens's");
  }
  bool resolve(DeviceDraws* draws) override {
    sigma_px_ = drawn_px_.sample(draws->of("exposure"));  // the name of the stream that it has always been drawn from
    return sigma_px_ > 0.0;
  }
  void label(Labels* labels) const override { (*labels)["defocus_sigma_px"] = sigma_px_; }
  bool changes_image() const override { return true; }
  void change_image(ImageF* electrons) const override { blur_samples(sigma_px_, electrons); }

 private:
  Distribution drawn_px_ = Distribution::Kind(Distribution::Uniform{0.0, 0.4});
  double sigma_px_ = 0.0;
};

}  // namespace

std::unique_ptr<ImageEffect> defocus_effect() { return std::make_unique<Defocus>(); }

}  // namespace rigproof
