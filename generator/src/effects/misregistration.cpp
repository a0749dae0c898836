// The depth image lies beside the colour image by whole pixels; what comes from outside is 0.
#include <cmath>

#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

void shift_image(int shift_x, int shift_y, ImageF* depth_m) {
  ImageF moved(depth_m->width, depth_m->height);
  const int width = depth_m->width - std::abs(shift_x);
  for (int y = 0; y < depth_m->height && width > 0; ++y) {
    const int source = y - shift_y;
    if (source < 0 || source >= depth_m->height) continue;
    std::copy_n(depth_m->row(source) + std::max(0, -shift_x), width, moved.row(y) + std::max(0, shift_x));
  }
  depth_m->pixels.swap(moved.pixels);
}

class Misregistration final : public ClonedEffect<DepthEffect, Misregistration> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("misregistration_px", drawn_px_, {-50.0, 50.0},
                  "shift of the depth image against the colour image, drawn for each camera and axis, in whole pixels");
  }
  bool resolve(const DepthDevice& /*device*/, DeviceDraws* draws) override {
    RandomStream& random = draws->of("depth device");
    x_px_ = static_cast<int>(std::lround(drawn_px_.sample(random)));
    y_px_ = static_cast<int>(std::lround(drawn_px_.sample(random)));
    return x_px_ != 0 || y_px_ != 0;
  }
  void label(Labels* labels) const override {
    if (x_px_ != 0) (*labels)["depth_shift_x_px"] = x_px_;
    if (y_px_ != 0) (*labels)["depth_shift_y_px"] = y_px_;
  }
  void tell(DepthNoise* told) const override { told->shift_sigma_px = DepthNoise().shift_sigma_px; }
  Place place() const override { return Place::kFrame; }
  bool changes_scene() const override { return true; }
  void change_scene(const Scene& /*scene*/, ImageF* depth_m) const override { shift_image(x_px_, y_px_, depth_m); }

 private:
  Distribution drawn_px_ = 0.0;
  int x_px_ = 0, y_px_ = 0;
};

}  // namespace

std::unique_ptr<DepthEffect> misregistration_effect() { return std::make_unique<Misregistration>(); }

}  // namespace rigproof
