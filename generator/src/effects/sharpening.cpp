// Unsharp masking, as processors of cameras do it: level + amount (Y - Y blurred), of all colours alike.
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

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
    for (int y = 0; y < image->height; ++y) {
      const std::uint8_t *sharp = gray.ptr(y), *soft = blurred.ptr(y);
      std::uint8_t* row = image->row(y);
      for (int x = 0; x < image->width; ++x) {
        const int detail = (scaled * (sharp[x] - soft[x])) / 256;
        for (int c = 0; c < 3; ++c)
          row[3 * x + c] = static_cast<std::uint8_t>(std::clamp(row[3 * x + c] + detail, 0, 255));
      }
    }
  }

 private:
  bool on_ = true;
  double amount_ = 0.5, sigma_px_ = 1.0;
};

}  // namespace

std::unique_ptr<ImageEffect> sharpening_effect() { return std::make_unique<Sharpening>(); }

}  // namespace rigproof
