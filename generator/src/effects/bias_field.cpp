// A smooth error of the device over its field of view, the same in every frame.
#include <cmath>
#include <optional>

#include "../sensing/normals.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

double bias_over_noise(const DepthSensing& depth, double bias) {
  const DepthNoise& noise = depth.stream.noise;
  const double sigma =
      depth.is_stereo() ? depth.focal_baseline_px_m * noise.inverse_depth_sigma_per_m : noise.sigma_m(1.0);
  return bias / sigma;
}

class BiasField final : public ClonedEffect<DepthEffect, BiasField> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("bias_field", on_, "smooth, fixed error of the device over its field of view");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("bias_px", bias_px_, {0.0, 2.0}, "stereo: smooth bias field of the device, one sigma");
    visitor.field("bias_m", bias_m_, {0.0, 0.2}, "time of flight: smooth bias field of the device, one sigma");
    visitor.field("bias_cell_deg", cell_deg_, {1.0, 90.0}, "angle over which the bias changes");
  }
  bool resolve(const DepthDevice& device, DeviceDraws* /*draws*/) override {
    const DepthSensing& depth = device.sensing;
    stereo_ = depth.is_stereo();
    bias_ = stereo_ ? bias_px_ : bias_m_;
    over_noise_ = bias_over_noise(depth, bias_);
    disparity_m_ = depth.focal_baseline_px_m;
    focal_px_ = depth.focal_px;
    cell_px_ = std::max(8.0, focal_px_ * std::tan(deg_to_rad(cell_deg_)));
    return on_ && bias_ > 0.0;
  }
  void label(Labels* labels) const override {
    (*labels)[stereo_ ? "depth_bias_sigma_px" : "depth_bias_sigma_m"] = bias_;
    // At 1 m; in stereo it is the same everywhere.
    (*labels)["depth_bias_over_noise"] = over_noise_;
  }
  void tell(DepthNoise* told) const override {
    (stereo_ ? told->bias_inverse_depth_per_m : told->bias_m) = stereo_ ? bias_ / disparity_m_ : bias_;
    told->bias_cell_deg = rad_to_deg(std::atan(cell_px_ / focal_px_));
  }
  void prepare(int width, int height, const FrameSeed& device) override {
    field_.emplace(width, height, cell_px_, device.stream("depth bias"));
    row_.resize(static_cast<std::size_t>(width));
  }
  void add_error(int y, float* error) const override {
    field_->row(y, row_.data());
    const auto bias = static_cast<float>(bias_);
    for (std::size_t x = 0; x < row_.size(); ++x) error[x] += bias * row_[x];
  }

 private:
  bool on_ = true, stereo_ = true;
  double bias_px_ = 0.05, bias_m_ = 0.003, cell_deg_ = 15.0;
  double bias_ = 0.0;  ///< px of disparity, or metres
  double over_noise_ = 0.0, disparity_m_ = 1.0, focal_px_ = 1.0, cell_px_ = 160.0;
  std::optional<SmoothField> field_;
  mutable std::vector<float> row_;  ///< scratch
};

}  // namespace

std::unique_ptr<DepthEffect> bias_field_effect() { return std::make_unique<BiasField>(); }

}  // namespace rigproof
