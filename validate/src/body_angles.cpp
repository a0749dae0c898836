#include "rigproof/validate/body_angles.h"

#include <algorithm>
#include <cmath>

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

Eigen::Vector3d camera_roll_pitch_yaw(const Eigen::Quaterniond& rotation_robot_camera) {
  return roll_pitch_yaw(rotation_robot_camera * optical_from_body());
}

// The rotation error along the parent's axes is carried over to the angles by central differences.
Vector6d pose_sigmas(const EstimatedTransform& transform) {
  Vector6d sigmas = Vector6d::Zero();
  if (!transform.covariance) return sigmas;
  const Matrix6d& covariance = *transform.covariance;
  Eigen::Matrix3d J;
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d up = camera_roll_pitch_yaw(so3_exp(step) * transform.T_parent_child.rotation);
    const Eigen::Vector3d down = camera_roll_pitch_yaw(so3_exp(-step) * transform.T_parent_child.rotation);
    for (int i = 0; i < 3; ++i) J(i, axis) = wrap_angle(up(i) - down(i)) / (2.0 * kStep);
  }
  const Eigen::Matrix3d angles = J * covariance.bottomRightCorner<3, 3>() * J.transpose();
  for (int i = 0; i < 3; ++i) {
    sigmas(i) = std::sqrt(std::max(0.0, covariance(i, i)));
    sigmas(i + 3) = std::sqrt(std::max(0.0, angles(i, i)));
  }
  return sigmas;
}

}  // namespace rigproof
