#include "rigproof/validate/body_angles.h"

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
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles) {
  return Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
}

Eigen::Vector3d roll_pitch_yaw_error(const Rigid3& T_estimate, const Rigid3& T_true, bool between_cameras) {
  const Eigen::Quaterniond child = optical_from_body();
  const Eigen::Quaterniond parent = between_cameras ? child.conjugate() : Eigen::Quaterniond::Identity();
  const Eigen::Vector3d difference =
      roll_pitch_yaw(parent * T_estimate.rotation * child) - roll_pitch_yaw(parent * T_true.rotation * child);
  return difference.unaryExpr([](double angle) { return wrap_angle(angle); });
}

Rigid3 with_unobservable_from(const Rigid3& T_true, const Rigid3& T_estimate, const std::array<bool, 6>& observable) {
  const Eigen::Quaterniond body = optical_from_body();
  Eigen::Vector3d translation = T_estimate.translation;
  Eigen::Vector3d angles = roll_pitch_yaw(T_estimate.rotation * body);
  const Eigen::Vector3d true_angles = roll_pitch_yaw(T_true.rotation * body);
  bool angle_missing = false;
  for (int i = 0; i < 3; ++i) {
    if (!observable[static_cast<std::size_t>(i)]) translation[i] = T_true.translation[i];
    if (observable[static_cast<std::size_t>(i) + 3U]) continue;
    angles[i] = true_angles[i];
    angle_missing = true;
  }
  if (!angle_missing) return Rigid3(T_estimate.rotation, translation);
  return Rigid3(from_roll_pitch_yaw(angles) * body.conjugate(), translation);
}

}  // namespace rigproof
