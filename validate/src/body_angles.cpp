#include "rigproof/validate/body_angles.h"

namespace rigproof {

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
