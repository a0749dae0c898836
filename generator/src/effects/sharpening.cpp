// Unsharp masking, as processors of cameras do it: level + amount (Y - Y blurred), of all colours alike.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rigproof/core/vector_clones.h"
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

// Once for each of the three colours, so that the sum over a row is one loop over bytes.
RIGPROOF_VECTOR_CLONES
void detail_of_row(const std::uint8_t* sharp, const std::uint8_t* soft, int scaled, int width, std::int16_t* detail) {
  for (int x = 0; x < width; ++x) {
    const auto added = static_cast<std::int16_t>((scaled * (sharp[x] - soft[x])) / 256);
    for (int c = 0; c < 3; ++c) detail[3 * x + c] = added;
  }
}

RIGPROOF_VECTOR_CLONES
void add_saturated(const std::vector<std::int16_t>& detail, std::uint8_t* row) {
  for (std::size_t i = 0; i < detail.size(); ++i)
    row[i] = static_cast<std::uint8_t>(std::clamp(row[i] + detail[i], 0, 255));
}

class Sharpening final : public ClonedEffect<ImageEffect, Sharpening> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("sharpening", on_, "the camera's processor sharpens its images, as the preset says");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("sharpening_amount", amount_, {0.0, 5.0}, "unsharp mask: share of what it adds to the image");
    visitor.field("sharpening_sigma_px", sigma_px_, {0.3, 10.0}, "unsharp mask: its blur, one sigma");
  }
  bool resolve(DeviceDraws* /*draws*/) override { return on_ && amount_ > 0.0; }
  void label(Labels* labels) const override {
    (*labels)["sharpening_amount"] = amount_;
    (*labels)["sharpening_sigma_px"] = sigma_px_;
  }
  void change_levels(Image8* image) const override {
    cv::Mat colors(image->height, image->width, CV_8UC3, image->pixels.data()), gray, blurred;
    cv::cvtColor(colors, gray, cv::COLOR_RGB2GRAY);
    cv::GaussianBlur(gray, blurred, cv::Size(), sigma_px_);
    const int scaled = static_cast<int>(std::lround(256.0 * amount_));
    std::vector<std::int16_t> detail(image->row_length());
    for (int y = 0; y < image->height; ++y) {
      detail_of_row(gray.ptr(y), blurred.ptr(y), scaled, image->width, detail.data());
      add_saturated(detail, image->row(y));
    }
  }

 private:
  bool on_ = true;
  double amount_ = 0.5, sigma_px_ = 1.0;
};

}  // namespace

std::unique_ptr<ImageEffect> sharpening_effect() { return std::make_unique<Sharpening>(); }

}  // namespace rigproof
