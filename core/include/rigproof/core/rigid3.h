// Rotations and rigid transforms in three dimensions: SO(3), SE(3), their exponential maps and Jacobians.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rigproof {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Matrix S with S * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);
/// Rotation by |phi| radians about phi (Rodrigues).
Eigen::Quaterniond so3_exp(const Eigen::Vector3d& phi);
/// Rotation vector in radians, |phi| <= pi; the inverse of so3_exp.
Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation);
/// J with Exp(phi + d) = Exp(J d) Exp(phi) to first order.
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi);
Eigen::Matrix3d so3_left_jacobian_inverse(const Eigen::Vector3d& phi);
/// Rotation by yaw_rad about z.
Eigen::Quaterniond rotation_z(double yaw_rad);

/// A rigid transform. Name variables T_target_source: p_target = T_target_source * p_source.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit norm
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< metres

  Rigid3() = default;
  Rigid3(const Eigen::Quaterniond& rotation_in, const Eigen::Vector3d& translation_in)
      : rotation(rotation_in.normalized()), translation(translation_in) {}
  /// Nearest rigid transform to a 4x4 matrix whose upper-left block is close to a rotation.
  static Rigid3 from_matrix(const Eigen::Matrix4d& matrix);

  Eigen::Matrix4d matrix() const;
  Eigen::Matrix3d rotation_matrix() const { return rotation.toRotationMatrix(); }
  Rigid3 inverse() const;
  Rigid3 operator*(const Rigid3& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
};

/// A pose on the ground plane as a rigid transform: yaw about z, then (x, y, 0).
Rigid3 planar_pose(double x_m, double y_m, double yaw_rad);
/// Heading of the transform's x axis projected on the xy plane, radians in (-pi, pi].
double yaw_of(const Rigid3& T);
/// Angle wrapped to (-pi, pi].
double wrap_angle(double angle_rad);

/// Exponential of xi = (rho, phi): the screw motion, metres and radians.
Rigid3 se3_exp(const Vector6d& xi);
/// Inverse of se3_exp.
Vector6d se3_log(const Rigid3& T);

/// The project's error of a transform (conventions.h): (t_est - t_true, Log(R_est R_true^T)), along the parent's axes.
Vector6d transform_error(const Rigid3& T_estimate, const Rigid3& T_true);
/// Applies an error in the same chart: transform_error(apply_transform_error(T, e), T) = e.
Rigid3 apply_transform_error(const Rigid3& T, const Vector6d& error);

}  // namespace rigproof
