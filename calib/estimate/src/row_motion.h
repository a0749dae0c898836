// Images taken at speed: rows are read one after the other, and each is the mean of its exposure.
#pragma once

#include "rigproof/calib/estimate/residuals.h"

namespace rigproof::ml {

/// By how much something is displaced at a moment, its twist, and how that changes: (6 x 1, 6 x 1, 6 x 1), by powers of
/// time.
inline constexpr int kMotion = 18;
using MotionVector = Eigen::Matrix<double, kMotion, 1>;
using MotionMatrix = Eigen::Matrix<double, kMotion, kMotion>;
using MotionBy6 = Eigen::Matrix<double, kMotion, 6>;

/// What the board does in the camera's coordinates while an image is taken, row by row. All times are after the middle
/// row's; a point q that lies a little aside, displaced as a whole, moves by [omega, v](t) q, with a twist (omega, v)
/// that changes evenly: robots speed up and swing while a row is exposed, by how much is unknown.
struct RowMotion {
  Vector6d velocity = Vector6d::Zero();           ///< of the robot by its odometry: (v, omega) along its axes
  MotionVector sigmas = MotionVector::Zero();     ///< of what the odometry does not tell [m, rad; by powers of s]
  Matrix6d twist_by_velocity = Matrix6d::Zero();  ///< a robot that moves carries its cameras along
  MotionVector twist = MotionVector::Zero();      ///< [rad, m; by powers of s]
  MotionVector error = MotionVector::Zero();      ///< of the robot's motion, whitened
  double readout_s = 0.0;                         ///< from the first row to the last
  int rows = 1;

  bool moves() const { return !velocity.isZero(0.0); }
  /// When a row is read, as a share of the readout.
  double share(double row) const { return (row + 0.5) / rows - 0.5; }
  /// Of the twist by the error of the robot's motion, whitened.
  MotionMatrix by_error() const;
  void set_error(const MotionVector& whitened);
  /// What is known by the twist, by that error.
  RowJacobian<2, kMotion> by_error(const RowJacobian<2, kMotion>& by_twist) const;
  /// Of the whitened error, where corners tell this much of the twist.
  MotionMatrix covariance_of_error(const MotionMatrix& information) const;
  /// The same of the twist.
  MotionMatrix covariance(const MotionMatrix& information) const;
  /// How the twist changes with the unknowns of the camera, by what they do to the board's twist.
  MotionBy6 by_camera(const Matrix6d& board_twist) const;
  /// The same of the twist at the middle row by the odometry's scale and yaw factor.
  Eigen::Matrix<double, 6, 2> by_factors(double scale, double yaw_factor) const;
};

/// @param odometry velocity as measured [m/s, m/s, rad/s]: its scale and yaw factor times the true one
/// @param displacement_scale times the least displacement
RowMotion row_motion(const Rigid3& T_robot_camera, const Eigen::Vector3d& odometry, double scale, double yaw_factor,
                     double displacement_scale);

/// Residual of a corner, with its derivatives by the twist of the board when the middle row is read, by the motion's
/// twist, and by the readout.
struct RowResidual : CornerResidual {
  Eigen::Vector3d point_camera;       ///< when the corner's row is read
  RowJacobian<2, kMotion> by_motion;  ///< only where there is a motion
  Eigen::Vector2d by_readout;
};
/// @param corner_camera when the middle row is read
/// Returns false where the point is not in front of the camera.
bool row_residual(const Camera& camera, const RowMotion& motion, const Eigen::Vector3d& corner_camera,
                  const Eigen::Vector2d& measured, RowResidual* residual);

}  // namespace rigproof::ml
