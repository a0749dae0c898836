#include "rigproof/core/rigid3.h"

#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// Below this angle the closed forms lose digits to cancellation, and two Taylor terms are exact to 1e-16.
constexpr double kSmallAngle = 1e-3;

// (1 - cos a) / a^2 and (a - sin a) / a^3.
struct JacobianCoefficients {
  double first, second;
};

JacobianCoefficients left_jacobian_coefficients(double angle) {
  const double a2 = angle * angle;
  if (angle < kSmallAngle) return {0.5 - a2 / 24.0, 1.0 / 6.0 - a2 / 120.0};
  const double half_sine = std::sin(0.5 * angle);
  return {2.0 * half_sine * half_sine / a2, (angle - std::sin(angle)) / (a2 * angle)};
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d S;
  S << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return S;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const double scale = angle < kSmallAngle ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d v = scale * phi;
  return Eigen::Quaterniond(std::cos(0.5 * angle), v.x(), v.y(), v.z()).normalized();
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double sine = v.norm();
  const double cosine = sign * rotation.w();
  if (sine < kSmallAngle) {
    const double ratio = sine / cosine;
    return (2.0 / cosine) * (1.0 - ratio * ratio / 3.0) * v;
  }
  return (2.0 * std::atan2(sine, cosine) / sine) * v;
}

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi) {
  const JacobianCoefficients c = left_jacobian_coefficients(phi.norm());
  const Eigen::Matrix3d S = skew(phi);
  return Eigen::Matrix3d::Identity() + c.first * S + c.second * S * S;
}

Eigen::Matrix3d so3_left_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d S = skew(phi);
  const double coefficient =
      angle < kSmallAngle ? 1.0 / 12.0 + angle * angle / 720.0
                          : (1.0 - 0.5 * angle * std::cos(0.5 * angle) / std::sin(0.5 * angle)) / (angle * angle);
  return Eigen::Matrix3d::Identity() - 0.5 * S + coefficient * S * S;
}

Eigen::Quaterniond rotation_z(double yaw_rad) {
  return Eigen::Quaterniond(std::cos(0.5 * yaw_rad), 0.0, 0.0, std::sin(0.5 * yaw_rad));
}

Rigid3 Rigid3::from_matrix(const Eigen::Matrix4d& matrix) {
  return Rigid3(Eigen::Quaterniond(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>())), matrix.topRightCorner<3, 1>());
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = rotation_matrix();
  T.topRightCorner<3, 1>() = translation;
  return T;
}

Rigid3 Rigid3::inverse() const {
  const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
  return Rigid3(inverse_rotation, -(inverse_rotation * translation));
}

Rigid3 Rigid3::operator*(const Rigid3& other) const {
  return Rigid3(rotation * other.rotation, rotation * other.translation + translation);
}

Rigid3 planar_pose(double x_m, double y_m, double yaw_rad) {
  return Rigid3(rotation_z(yaw_rad), Eigen::Vector3d(x_m, y_m, 0.0));
}

double yaw_of(const Rigid3& T) {
  const Eigen::Vector3d forward = T.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

Rigid3 se3_exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return Rigid3(so3_exp(phi), so3_left_jacobian(phi) * xi.head<3>());
}

Vector6d se3_log(const Rigid3& T) {
  Vector6d xi;
  const Eigen::Vector3d phi = so3_log(T.rotation);
  xi << so3_left_jacobian_inverse(phi) * T.translation, phi;
  return xi;
}

Vector6d transform_error(const Rigid3& T_estimate, const Rigid3& T_true) {
  Vector6d error;
  error << T_estimate.translation - T_true.translation, so3_log(T_estimate.rotation * T_true.rotation.conjugate());
  return error;
}

Rigid3 apply_transform_error(const Rigid3& T, const Vector6d& error) {
  return Rigid3(so3_exp(error.tail<3>()) * T.rotation, T.translation + error.head<3>());
}

}  // namespace rigproof
