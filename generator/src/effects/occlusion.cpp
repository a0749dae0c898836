// No depth where one of the sensor's imagers does not see the point.
#include <cmath>

#include "../sensing/inverse_depth.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

// Takes the depth away where an imager, beside the camera by `offset_m` along x, does not see the point: left of near
// things for one on the right. The shadow of an edge is focal * offset * (1/z_near - 1/z_far) pixels wide.
void remove_hidden(const ImageF& clean, double focal_px, double offset_m, ImageF* depth_m) {
  const auto width = static_cast<std::size_t>(clean.width);
  std::vector<float> shift(width);
  // Mirrored for an imager on the left, so that both are scanned the same way: from the side of the imager, a point is
  // hidden if one that was passed before already covers its place or a place beyond.
  const bool right = offset_m > 0.0;
  const auto factor = static_cast<float>(focal_px * std::abs(offset_m));
  for (int y = 0; y < clean.height; ++y) {
    invert_row(clean.row(y), width, factor, shift.data());
    float* out = depth_m->row(y);
    float covered = 2.0F * static_cast<float>(width);
    for (std::size_t i = 0; i < width; ++i) {
      const std::size_t x = right ? width - 1 - i : i;
      const float place = static_cast<float>(width - 1 - i) - shift[x];
      if (place >= covered)
        out[x] = 0.0F;
      else
        covered = place;
    }
  }
}

class Occlusion final : public ClonedEffect<DepthEffect, Occlusion> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("occlusion", on_, "no depth where one of the sensor's imagers does not see the point");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("imagers_x_m", imagers_x_m_, {-1.0, 1.0}, 0, 2,
                  "places of the imagers along the colour camera's x axis; depth is where all of them see the point");
  }
  bool resolve(const DepthDevice& device, DeviceDraws* /*draws*/) override {
    focal_px_ = device.sensing.focal_px;
    // They are told beside the colour camera, and wanted beside the depth image's own place.
    if (const auto& own = device.sensing.stream.own_camera)
      for (double& x_m : imagers_x_m_) x_m -= own->T_color_depth.translation.x();
    return on_ && !imagers_x_m_.empty();
  }
  void label(Labels* labels) const override { (*labels)["occlusion"] = 1.0; }
  bool changes_scene() const override { return true; }
  void change_scene(const Scene& scene, ImageF* depth_m) const override {
    for (const double x_m : imagers_x_m_) remove_hidden(scene.clean_m, focal_px_, x_m, depth_m);
  }

 private:
  bool on_ = true;
  std::vector<double> imagers_x_m_;
  double focal_px_ = 0.0;
};

}  // namespace

std::unique_ptr<DepthEffect> occlusion_effect() { return std::make_unique<Occlusion>(); }

}  // namespace rigproof
