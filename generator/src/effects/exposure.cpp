// Light of a whole frame over that of the render: the camera's own, and what its control does from frame to frame.
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

class ExposureError final : public ClonedEffect<ImageEffect, ExposureError> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("exposure", drawn_, {0.05, 20.0}, "light over that of the render, drawn for each camera");
    visitor.field("exposure_jitter_percent", jitter_percent_, {0.0, 50.0},
                  "exposure differs from frame to frame, one sigma");
  }
  bool resolve(DeviceDraws* draws) override {
    exposure_ = drawn_.sample(draws->of("exposure"));
    jitter_ = jitter_percent_ / 100.0;
    return exposure_ != 1.0 || jitter_ > 0.0;
  }
  void label(Labels* labels) const override {
    if (exposure_ != 1.0) (*labels)["exposure"] = exposure_;
    if (jitter_ > 0.0) (*labels)["exposure_jitter_percent"] = 100.0 * jitter_;
  }
  double light_of_frame(const FrameSeed& frame) const override {
    const double jitter = jitter_ > 0.0 ? frame.stream("exposure").normal() * jitter_ : 0.0;
    return exposure_ * std::max(0.01, 1.0 + jitter);
  }

 private:
  Distribution drawn_ = 1.0;
  double jitter_percent_ = 2.0, exposure_ = 1.0, jitter_ = 0.0;
};

}  // namespace

std::unique_ptr<ImageEffect> exposure_effect() { return std::make_unique<ExposureError>(); }

}  // namespace rigproof
