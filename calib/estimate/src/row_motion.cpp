#include "row_motion.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rigproof::ml {
namespace {

// Standard deviations by which a robot moves otherwise than its odometry says at a moment: tyres slip and give way
// where it turns, and its body swings while it speeds up or brakes. Of rendered drives of a skid-steered robot.
Vector6d sigmas_of_velocity(double turn_rate_rad_s) {
  constexpr double kAlong_m_s = 1e-3, kUp_m_s = 2e-3, kTilting_rad_s = 5e-3, kTurn_rad_s = 1e-3;
  constexpr double kAlongByTurn_m = 8e-3, kTurnByTurn = 0.05;
  const double along = std::hypot(kAlong_m_s, kAlongByTurn_m * turn_rate_rad_s);
  const double turn = std::hypot(kTurn_rad_s, kTurnByTurn * turn_rate_rad_s);
  Vector6d sigmas;
  sigmas << along, along, kUp_m_s, kTilting_rad_s, kTilting_rad_s, turn;
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

void RowMotion::set_error(const Vector6d& whitened) {
  twist = twist_by_velocity * (velocity + velocity_sigmas.cwiseProduct(whitened));
  error_square = whitened.squaredNorm();
}

Matrix6d RowMotion::covariance(const Matrix6d& information) const {
  const Matrix6d by = by_error();
  return by * (Matrix6d::Identity() + by.transpose() * information * by).ldlt().solve(Matrix6d(by.transpose()));
}

Matrix6d RowMotion::by_camera(const Matrix6d& board_twist) const { return -bracket(twist) * board_twist; }

Eigen::Matrix<double, 6, 2> RowMotion::by_factors(double scale, double yaw_factor) const {
  Eigen::Matrix<double, 6, 2> by;
  by.col(0) = -twist_by_velocity.leftCols<2>() * velocity.head<2>() / scale;
  by.col(1) = -twist_by_velocity.col(5) * velocity[5] / yaw_factor;
  return by;
}

RowMotion row_motion(const Rigid3& T_robot_camera, const Eigen::Vector3d& odometry, double scale, double yaw_factor) {
  RowMotion motion;
  motion.velocity << odometry.x() / scale, odometry.y() / scale, 0.0, 0.0, 0.0, odometry.z() / yaw_factor;
  motion.velocity_sigmas = sigmas_of_velocity(odometry.z());
  const Eigen::Matrix3d R_camera_robot = T_robot_camera.rotation_matrix().transpose();
  Matrix6d& by = motion.twist_by_velocity;
  by.topRightCorner<3, 3>() = by.bottomLeftCorner<3, 3>() = -R_camera_robot;
  by.bottomRightCorner<3, 3>() = R_camera_robot * skew(T_robot_camera.translation);
  motion.twist = by * motion.velocity;
  return motion;
}

// Turns are taken to their second power: the third is 5e-6 of a turn by .03 rad, as 2 rad/s are in half of 30 ms.
bool row_residual(const Camera& camera, const RowMotion& motion, const Eigen::Vector3d& corner_camera,
                  const Eigen::Vector2d& measured, RowResidual* residual) {
  residual->point_camera = corner_camera;
  residual->by_readout.setZero();
  if (!motion.moves()) return corner_residual(camera, corner_camera, measured, residual);
  const double share = motion.share(measured.y()), t = share * motion.readout_s;
  const Eigen::Vector3d omega = motion.twist.head<3>();
  const Eigen::Vector3d moving = omega.cross(corner_camera) + motion.twist.tail<3>();
  residual->point_camera = corner_camera + t * moving + 0.5 * t * t * omega.cross(moving);
  if (!corner_residual(camera, residual->point_camera, measured, residual)) return false;
  residual->by_readout = share * residual->by_point * (omega.cross(residual->point_camera) + motion.twist.tail<3>());
  if (!motion.bends_views()) return true;
  const Eigen::Matrix3d turning = skew(omega);
  residual->by_point *= Eigen::Matrix3d::Identity() + t * turning + 0.5 * t * t * turning * turning;
  for (int row = 0; row < 2; ++row) {
    const Eigen::Vector3d a = residual->by_point.row(row);
    residual->by_twist.row(row) << corner_camera.cross(a).transpose(), a.transpose();
  }
  residual->by_motion = t * (residual->by_twist - 0.5 * t * residual->by_twist * bracket(motion.twist));
  return true;
}

}  // namespace rigproof::ml
