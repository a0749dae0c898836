// What the user is told of the lens against what is true.
#include "resolve.h"

namespace rigproof {

void LensSensingConfig::visit(FieldVisitor& visitor) {
  visitor.field("focal_error_percent", focal_error_percent, {-10.0, 10.0},
                "the focal length that the user is told is too large by this, drawn for each camera");
  visitor.field("centre_error_px", centre_error_px, {-50.0, 50.0},
                "the same for the principal point, drawn for each camera and axis");
  visitor.field("distortion_error_percent", distortion_error_percent, {-100.0, 100.0},
                "the same for each coefficient of the lens");
}

bool is_exact(const LensSensingConfig& config) {
  const auto is_zero = [](const Distribution& error) { return error.lowest() == 0.0 && error.highest() == 0.0; };
  return is_zero(config.focal_error_percent) && is_zero(config.centre_error_px) &&
         is_zero(config.distortion_error_percent);
}

Camera told_camera(const Camera& camera, const LensSensingConfig& config, std::uint64_t seed, std::int32_t index) {
  RandomStream random(seed, "lens", -1, index);
  Camera told = camera;
  const double focal = 1.0 + config.focal_error_percent.sample(random) / 100.0;
  told.fx_px *= focal;
  told.fy_px *= focal;
  told.cx_px += config.centre_error_px.sample(random);
  told.cy_px += config.centre_error_px.sample(random);
  for (double& coefficient : told.distortion)
    coefficient *= 1.0 + config.distortion_error_percent.sample(random) / 100.0;
  return told;
}

}  // namespace rigproof
