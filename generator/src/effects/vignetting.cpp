// The lens passes less light towards the corners: 1 / (1 + falloff r^2)^2, r = 1 in the corner.
#include <cmath>

#include "rigproof/core/vector_clones.h"
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

RIGPROOF_VECTOR_CLONES
void dim_row(float falloff, float y2, float x_first, float x_step, std::size_t pixels, float* light) {
  for (std::size_t x = 0; x < pixels; ++x) {
    const float across = x_first + x_step * static_cast<float>(x);
    const float loss = 1.0F + falloff * (across * across + y2);
    light[x] /= loss * loss;
  }
}

class Vignetting final : public ClonedEffect<ImageEffect, Vignetting> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("vignetting", on_, "the lens passes less light towards the corners");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("corner_light_percent", corner_light_percent_, {5.0, 100.0},
                  "vignetting: light in the image's corner over that in its centre");
  }
  bool resolve(DeviceDraws* /*draws*/) override {
    corner_light_ = corner_light_percent_ / 100.0;
    return on_ && corner_light_ < 1.0;
  }
  void label(Labels* labels) const override { (*labels)["corner_light_percent"] = 100.0 * corner_light_; }
  void prepare(int width, int height, const FrameSeed& /*device*/) override {
    falloff_ = static_cast<float>(1.0 / std::sqrt(corner_light_) - 1.0);
    half_x_ = 0.5F * static_cast<float>(width - 1);
    half_y_ = 0.5F * static_cast<float>(height - 1);
  }
  void change_light(int y, std::size_t pixels, float* light) const override {
    const float corner = std::sqrt(half_x_ * half_x_ + half_y_ * half_y_);
    const float v = (static_cast<float>(y) - half_y_) / corner;
    dim_row(falloff_, v * v, -half_x_ / corner, 1.0F / corner, pixels, light);
  }

 private:
  bool on_ = true;
  double corner_light_percent_ = 60.0, corner_light_ = 1.0;
  float falloff_ = 0.0F, half_x_ = 0.0F, half_y_ = 0.0F;
};

}  // namespace

std::unique_ptr<ImageEffect> vignetting_effect() { return std::make_unique<Vignetting>(); }

}  // namespace rigproof
