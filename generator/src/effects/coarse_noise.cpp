// Part of the depth noise is no white noise of matching windows: patches, and ripples along the columns. The variance
// is made of three parts that add up to 1.
#include <cmath>

#include "../sensing/normals.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

// Ripples lean by this part of their length from row to row.
constexpr double kRippleLean = 0.02;

// The patches of one frame, with the row that they are written to.
struct Patches {
  SmoothField field;
  std::vector<float> row;
};

class CoarseNoise final : public ClonedEffect<DepthEffect, CoarseNoise> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("coarse_noise", on_, "part of the noise is patchy and rippled, as the preset says");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("patchy_share", patchy_share_, {0.0, 1.0}, "of the noise's variance, what varies patch by patch");
    visitor.field("ripple_share", ripple_share_, {0.0, 1.0}, "of the noise's variance, waves along the columns");
    visitor.field("ripple_px", ripple_px_, {2.0, 500.0}, "length of a wave");
    visitor.check(patchy_share_ + ripple_share_ <= 1.0, "patchy_share",
                  "patchy_share and ripple_share are parts of one variance: together at most 1");
  }
  bool resolve(const DepthDevice& device, DeviceDraws* /*draws*/) override {
    patch_px_ = device.sensing.patch_px;
    return on_ && device.sensing.noise && (patchy_share_ > 0.0 || ripple_share_ > 0.0);
  }
  void label(Labels* labels) const override {
    if (patchy_share_ > 0.0) (*labels)["depth_patchy_share"] = patchy_share_;
    if (ripple_share_ > 0.0) (*labels)["depth_ripple_share"] = ripple_share_;
  }
  void prepare(int width, int height, const FrameSeed& /*device*/) override {
    width_ = width;
    height_ = height;
    for (int x = 0; x < width && ripple_share_ > 0.0; ++x) {
      const double angle = 2.0 * kPi * static_cast<double>(x) / ripple_px_;
      sine_.push_back(static_cast<float>(std::sin(angle)));
      cosine_.push_back(static_cast<float>(std::cos(angle)));
    }
  }
  ChangeRow noise_of(const FrameSeed& frame) const override {
    std::shared_ptr<Patches> patches;
    if (patchy_share_ > 0.0)
      patches =
          std::make_shared<Patches>(Patches{SmoothField(width_, height_, patch_px_, frame.stream("depth patches")),
                                            std::vector<float>(static_cast<std::size_t>(width_))});
    const double phase = ripple_share_ > 0.0 ? 2.0 * kPi * frame.stream("depth ripples").uniform() : 0.0;
    return [this, patches, phase](int y, float* row) { change_row(y, patches.get(), phase, row); };
  }

 private:
  void change_row(int y, Patches* patches, double phase_of_frame, float* row) const {
    const auto width = static_cast<std::size_t>(width_);
    const auto fine = static_cast<float>(std::sqrt(std::max(0.0, 1.0 - patchy_share_ - ripple_share_)));
    const auto patchy = static_cast<float>(std::sqrt(patchy_share_)),
               ripple = static_cast<float>(std::sqrt(2.0 * ripple_share_));
    for (std::size_t x = 0; x < width; ++x) row[x] *= fine;
    if (patches != nullptr) {
      patches->field.row(y, patches->row.data());
      for (std::size_t x = 0; x < width; ++x) row[x] += patchy * patches->row[x];
    }
    if (ripple <= 0.0F) return;
    const double phase = phase_of_frame + 2.0 * kPi * kRippleLean * y;
    const float sine = ripple * static_cast<float>(std::sin(phase)),
                cosine = ripple * static_cast<float>(std::cos(phase));
    for (std::size_t x = 0; x < width; ++x) row[x] += cosine * sine_[x] + sine * cosine_[x];
  }

  bool on_ = true;
  double patchy_share_ = 0.0, ripple_share_ = 0.0, ripple_px_ = 12.0, patch_px_ = 24.0;
  int width_ = 0, height_ = 0;
  std::vector<float> sine_, cosine_;
};

}  // namespace

std::unique_ptr<DepthEffect> coarse_noise_effect() { return std::make_unique<CoarseNoise>(); }

}  // namespace rigproof
