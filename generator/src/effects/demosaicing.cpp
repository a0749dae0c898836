// A colour filter over every pixel, and the two missing colours guessed from the neighbours: Bayer's pattern, red in
// the top left corner, and OpenCV's edge-aware interpolation of the levels.
#include <opencv2/imgproc.hpp>

#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

class Demosaicing final : public ClonedEffect<ImageEffect, Demosaicing> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("demosaicing", on_, "pixels see one colour each, the others are guessed from their neighbours");
  }
  bool resolve(DeviceDraws* /*draws*/) override { return on_; }
  void label(Labels* labels) const override { (*labels)["demosaicing"] = 1.0; }
  void change_levels(Image8* image) const override {
    cv::Mat mosaic(image->height, image->width, CV_8UC1),
        colors(image->height, image->width, CV_8UC3, image->pixels.data());
    for (int y = 0; y < image->height; ++y) {
      const std::uint8_t* row = image->row(y);
      std::uint8_t* out = mosaic.ptr(y);
      for (int x = 0; x < image->width; ++x) out[x] = row[3 * x + (x & 1) + (y & 1)];
    }
    // OpenCV names a pattern by the second row's second and third pixel.
    cv::demosaicing(mosaic, colors, cv::COLOR_BayerBG2RGB_EA);
  }

 private:
  bool on_ = true;
};

}  // namespace

std::unique_ptr<ImageEffect> demosaicing_effect() { return std::make_unique<Demosaicing>(); }

}  // namespace rigproof
