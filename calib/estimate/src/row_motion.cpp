#include "row_motion.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "rigproof/calib/estimate/noise.h"

namespace rigproof::ml {
namespace {

// Standard deviations by which a robot moves otherwise than its odometry says at a moment: tyres slip and give way
// where it turns, and its body swings while it speeds up or brakes. Of rendered drives of a skid-steered robot and a
// cart.
MotionVector sigmas_of_motion(double turn_rate_rad_s, double displacement_scale) {
  constexpr double kAlong_m_s = 1e-3, kUp_m_s = 2e-3, kTilting_rad_s = 5e-3, kTurn_rad_s = 1e-3;
  constexpr double kAlongByTurn_m = 8e-3, kTurnByTurn = 0.05;
  constexpr double kAlong_m_s2 = 0.3, kUp_m_s2 = 0.3, kTurning_rad_s2 = 1.8;
  const double along = std::hypot(kAlong_m_s, kAlongByTurn_m * turn_rate_rad_s);
  const double turn = std::hypot(kTurn_rad_s, kTurnByTurn * turn_rate_rad_s);
  const double shifted_m = displacement_scale * kLeastDisplacement_m;
  const double turned_rad = displacement_scale * kLeastDisplacement_rad;
  const Eigen::Vector3d any = Eigen::Vector3d::Ones();
  MotionVector sigmas;
  sigmas << shifted_m * any, turned_rad * any, along, along, kUp_m_s, kTilting_rad_s, kTilting_rad_s, turn, kAlong_m_s2,
      kAlong_m_s2, kUp_m_s2, kTurning_rad_s2 * any;
  return sigmas;
}

// [a, b] of twists (omega, v) by b.
Matrix6d bracket(const Vector6d& a) {
  Matrix6d by = Matrix6d::Zero();
  by.topLeftCorner<3, 3>() = by.bottomRightCorner<3, 3>() = skew(a.head<3>());
  by.bottomLeftCorner<3, 3>() = skew(a.tail<3>());
  return by;
}

}  // namespace

MotionMatrix RowMotion::by_error() const {
  MotionMatrix by = MotionMatrix::Zero();
  for (int i = 0; i < kMotion; i += 6) by.block<6, 6>(i, i) = twist_by_velocity;
  return by * sigmas.asDiagonal();
}

RowJacobian<2, kMotion> RowMotion::by_error(const RowJacobian<2, kMotion>& by_twist) const {
  RowJacobian<2, kMotion> by;
  for (int i = 0; i < kMotion; i += 6) by.middleCols<6>(i) = by_twist.middleCols<6>(i).lazyProduct(twist_by_velocity);
  return by * sigmas.asDiagonal();
}

void RowMotion::set_error(const MotionVector& whitened) {
  MotionVector of_robot = sigmas.cwiseProduct(whitened);
  of_robot.segment<6>(6) += velocity;
  for (int i = 0; i < kMotion; i += 6) twist.segment<6>(i) = twist_by_velocity * of_robot.segment<6>(i);
  error = whitened;
}

MotionMatrix RowMotion::covariance_of_error(const MotionMatrix& information) const {
  const MotionMatrix by = by_error();
  const MotionMatrix of_error = MotionMatrix::Identity() + by.transpose() * information * by;
  return of_error.ldlt().solve(MotionMatrix(MotionMatrix::Identity()));
}

MotionMatrix RowMotion::covariance(const MotionMatrix& information) const {
  const MotionMatrix by = by_error();
  return by * covariance_of_error(information) * by.transpose();
}

MotionBy6 RowMotion::by_camera(const Matrix6d& board_twist) const {
  MotionBy6 by;
  for (int i = 0; i < kMotion; i += 6) by.middleRows<6>(i) = -bracket(twist.segment<6>(i)) * board_twist;
  return by;
}

Eigen::Matrix<double, 6, 2> RowMotion::by_factors(double scale, double yaw_factor) const {
  Eigen::Matrix<double, 6, 2> by;
  by.col(0) = -twist_by_velocity.leftCols<2>() * velocity.head<2>() / scale;
  by.col(1) = -twist_by_velocity.col(5) * velocity[5] / yaw_factor;
  return by;
}

RowMotion row_motion(const Rigid3& T_robot_camera, const Eigen::Vector3d& odometry, double scale, double yaw_factor,
                     double displacement_scale) {
  RowMotion motion;
  motion.velocity << odometry.x() / scale, odometry.y() / scale, 0.0, 0.0, 0.0, odometry.z() / yaw_factor;
  motion.sigmas = sigmas_of_motion(odometry.z(), displacement_scale);
  const Eigen::Matrix3d R_camera_robot = T_robot_camera.rotation_matrix().transpose();
  Matrix6d& by = motion.twist_by_velocity;
  by.topRightCorner<3, 3>() = by.bottomLeftCorner<3, 3>() = -R_camera_robot;
  by.bottomRightCorner<3, 3>() = R_camera_robot * skew(T_robot_camera.translation);
  motion.set_error(MotionVector::Zero());
  return motion;
}

// Turns are taken to their second power: the third is 5e-6 of a turn by .03 rad, as 2 rad/s are in half of 30 ms.
bool row_residual(const Camera& camera, const RowMotion& motion, const Eigen::Vector3d& corner_camera,
                  const Eigen::Vector2d& measured, RowResidual* residual) {
  residual->point_camera = corner_camera;
  residual->by_readout.setZero();
  if (!motion.moves()) return corner_residual(camera, corner_camera, measured, residual);
  const double share = motion.share(measured.y()), t = share * motion.readout_s, half_square = 0.5 * t * t;
  const auto part = [&motion](int i) -> Eigen::Vector3d { return motion.twist.segment<3>(i); };
  const Eigen::Vector3d omega = part(6), omega_change = part(12);
  const auto changes = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return omega_change.cross(point) + part(15);
  };
  const Eigen::Vector3d there = corner_camera + part(0).cross(corner_camera) + part(3);
  const Eigen::Vector3d moving = omega.cross(there) + part(9);
  residual->point_camera = there + t * moving + half_square * (omega.cross(moving) + changes(there));
  if (!corner_residual(camera, residual->point_camera, measured, residual)) return false;
  const Eigen::Vector3d& q = residual->point_camera;
  residual->by_readout = share * residual->by_point * (omega.cross(q) + part(9) + t * changes(q));
  const Eigen::Matrix3d turning = skew(omega), displaced = Eigen::Matrix3d::Identity() + skew(part(0));
  const Eigen::Matrix3d by_there =
      Eigen::Matrix3d::Identity() + t * turning + half_square * (turning * turning + skew(omega_change));
  for (int row = 0; row < 2; ++row) {
    const Eigen::Vector3d a = residual->by_point.row(row), turned = a.cross(omega), by_turn = there.cross(a);
    const Eigen::Vector3d shift = a.transpose() * by_there, by = shift.transpose() * displaced;
    residual->by_motion.row(row) << corner_camera.cross(shift).transpose(), shift.transpose(),
        (t * by_turn + half_square * (moving.cross(a) + there.cross(turned))).transpose(),
        (t * a + half_square * turned).transpose(), half_square * by_turn.transpose(), half_square * a.transpose();
    residual->by_point.row(row) = by;
    residual->by_twist.row(row) << corner_camera.cross(by).transpose(), by.transpose();
  }
  return true;
}

}  // namespace rigproof::ml
