// The hand-eye equation A X = X B of the MEMROC family as a residual, for doubles and for automatic derivatives.
#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Rigid3 over any scalar.
template <typename T>
struct RigidOf {
  Eigen::Quaternion<T> rotation;
  Eigen::Matrix<T, 3, 1> translation;

  static RigidOf from(const Rigid3& rigid) {
    return {rigid.rotation.template cast<T>(), rigid.translation.template cast<T>()};
  }
  /// The pose at an error of transform_error() from a reference: tx ty tz rx ry rz.
  static RigidOf at(const Rigid3& reference, const T* error) {
    T q[4];
    ceres::AngleAxisToQuaternion(error + 3, q);
    const Eigen::Quaternion<T> turn(q[0], q[1], q[2], q[3]);
    const Eigen::Matrix<T, 3, 1> shift(error[0], error[1], error[2]);
    return {turn * reference.rotation.template cast<T>(), reference.translation.template cast<T>() + shift};
  }
  RigidOf inverse() const {
    const Eigen::Quaternion<T> q = rotation.conjugate();
    return {q, -(q * translation)};
  }
  RigidOf operator*(const RigidOf& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
};

/// t(A X) - t(X B) [m] and Log((R_A R_X)^-1 R_X R_B) [rad]: the geodesic between the two rotations.
template <typename T>
void hand_eye_residual(const RigidOf<T>& A, const RigidOf<T>& X, const RigidOf<T>& B, T* residual) {
  const RigidOf<T> left = A * X, right = X * B;
  Eigen::Map<Eigen::Matrix<T, 3, 1>> translation(residual);
  translation = left.translation - right.translation;
  const Eigen::Quaternion<T> between = left.rotation.conjugate() * right.rotation;
  const T q[4] = {between.w(), between.x(), between.y(), between.z()};
  ceres::QuaternionToAngleAxis(q, residual + 3);
}

}  // namespace rigproof
