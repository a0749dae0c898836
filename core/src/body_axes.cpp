#include "rigproof/core/body_axes.h"

#include <cmath>

namespace rigproof {

Eigen::Quaterniond optical_from_body() {
  Eigen::Matrix3d R;  // columns: forward, left and up in optical axes
  R << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  return Eigen::Quaterniond(R);
}

Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const double cosine_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cosine_pitch);
  // Within 1e-9 of the pole roll and yaw are one angle; all of it is called yaw.
  if (cosine_pitch < 1e-9) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  // Roll about the axes that this very yaw gives: near the pole neither means much by itself, but both together do.
  const double yaw = std::atan2(R(1, 0), R(0, 0)), c = std::cos(yaw), s = std::sin(yaw);
  return {std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1)), pitch, yaw};
}

Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles) {
  return Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
}

}  // namespace rigproof
