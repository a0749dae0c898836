// Outdoors time of flight loses most of its pixels, patch by patch, and of its range.
#include "../sensing/normals.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

// Takes measurements away, patch by patch, until about `valid_share` is left.
void remove_share(double valid_share, double patch_px, RandomStream random, Image16* counts) {
  // The quantile of the standard normal field below which a pixel is lost.
  const std::vector<float>& normals = normal_table();
  const double lost = std::clamp(1.0 - valid_share, 0.0, 1.0);
  const auto index = static_cast<std::size_t>(lost * static_cast<double>(normals.size() - 1));
  const float threshold = normals[index];
  const SmoothField patches(counts->width, counts->height, std::max(2.0, patch_px / 4.0), random);
  std::vector<float> field(counts->row_length());
  for (int y = 0; y < counts->height; ++y) {
    patches.row(y, field.data());
    std::uint16_t* out = counts->row(y);
    for (std::size_t x = 0; x < field.size(); ++x)
      if (field[x] < threshold) out[x] = 0;
  }
}

class Daylight final : public ClonedEffect<DepthEffect, Daylight> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("daylight", on_, "outdoors time of flight loses most of its pixels and of its range");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("outdoor_valid_share", valid_share_, {0.0, 1.0}, "of the pixels, in daylight");
    visitor.field("outdoor_max_m", max_m_, {0.0, 1000.0}, "range in daylight");
  }
  bool resolve(const DepthDevice& device, DeviceDraws* /*draws*/) override {
    if (!on_ || !device.outdoors) return false;
    DepthStream& stream = device.sensing.stream;
    stream.max_m = std::min(stream.max_m, std::max(max_m_, stream.min_m));
    patch_px_ = device.sensing.patch_px;
    return valid_share_ < 1.0;
  }
  void label(Labels* labels) const override { (*labels)["depth_valid_share"] = valid_share_; }
  void change_counts(const FrameSeed& frame, Image16* counts) const override {
    remove_share(valid_share_, patch_px_, frame.stream("depth daylight"), counts);
  }

 private:
  bool on_ = true;
  double valid_share_ = 1.0, max_m_ = 1000.0, patch_px_ = 24.0;
};

}  // namespace

std::unique_ptr<DepthEffect> daylight_effect() { return std::make_unique<Daylight>(); }

}  // namespace rigproof
