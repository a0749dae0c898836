#include "rigproof/core/rig.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace rigproof {

void DepthNoise::doubt_place_and_common_scale() {
  const DepthNoise usual;
  common_scale_sigma = usual.common_scale_sigma;
  offset_sigma_m = usual.offset_sigma_m;
  tilt_sigma_rad = usual.tilt_sigma_rad;
  shift_sigma_px = usual.shift_sigma_px;
}

double DepthNoise::sigma_m(double depth_m) const {
  if (law == Law::kStereo) return depth_m * depth_m * inverse_depth_sigma_per_m;
  return constant_m + proportional * depth_m;
}

double DepthNoise::inverse_depth_sigma(double depth_m) const {
  if (law == Law::kStereo) return inverse_depth_sigma_per_m;
  return sigma_m(depth_m) / (depth_m * depth_m);
}

double DepthNoise::inverse_depth_bias(double inverse_depth_per_m) const {
  if (law == Law::kStereo) return bias_inverse_depth_per_m;
  return bias_m * inverse_depth_per_m * inverse_depth_per_m;
}

int first_of_make(const std::vector<RigCamera>& cameras, int camera) {
  const std::string& make = cameras[static_cast<std::size_t>(camera)].sensor;
  if (make.empty()) return camera;
  const auto first = std::find_if(cameras.begin(), cameras.begin() + camera,
                                  [&make](const RigCamera& other) { return other.depth && other.sensor == make; });
  return static_cast<int>(first - cameras.begin());
}

Eigen::Vector3d odometry_of_point(const Eigen::Vector3d& odometry, const Eigen::Vector2d& offset_m) {
  const Eigen::Vector2d moved = Eigen::Rotation2Dd(odometry.z()) * offset_m;
  return {odometry.x() + moved.x(), odometry.y() + moved.y(), odometry.z()};
}

const char* odometry_model_name(OdometryModel model) {
  switch (model) {
    case OdometryModel::kPerPose:
      return "per_pose";
    case OdometryModel::kPerIncrement:
      return "per_increment";
    case OdometryModel::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace rigproof
