// Rolling shutter: rows are read one after the other, while the robot moves.
#pragma once

#include "rigproof/calib/estimate/residuals.h"

namespace rigproof::ml {

/// What the board does in the camera's coordinates while the rows of an image are read. All times are after the middle
/// row's; the twist (omega, v) is constant, so that a point q lies at exp(t [twist]) q.
struct RowMotion {
  Vector6d velocity = Vector6d::Zero();           ///< of the robot by its odometry: (v, omega) along its axes
  Vector6d velocity_sigmas = Vector6d::Zero();    ///< of what the odometry does not tell [m/s, rad/s]
  Matrix6d twist_by_velocity = Matrix6d::Zero();  ///< a robot that moves carries its cameras along
  Vector6d twist = Vector6d::Zero();              ///< [rad/s, m/s]
  double error_square = 0.0;                      ///< of the velocity's error, whitened
  double readout_s = 0.0;                         ///< from the first row to the last
  int rows = 1;

  bool moves() const { return !velocity.isZero(0.0); }
  /// Whether the rows of a view show the board in different places.
  bool bends_views() const { return readout_s != 0.0 && moves(); }
  /// When a row is read, as a share of the readout.
  double share(double row) const { return (row + 0.5) / rows - 0.5; }
  /// Of the twist by the error of the velocity, whitened.
  Matrix6d by_error() const { return twist_by_velocity * velocity_sigmas.asDiagonal(); }
  void set_error(const Vector6d& whitened);
  /// Of the twist, where corners tell this much of it.
  Matrix6d covariance(const Matrix6d& information) const;
  /// How the twist changes with the unknowns of the camera, by what they do to the board's twist.
  Matrix6d by_camera(const Matrix6d& board_twist) const;
  /// The same by the odometry's scale and yaw factor.
  Eigen::Matrix<double, 6, 2> by_factors(double scale, double yaw_factor) const;
};

/// @param odometry velocity as measured [m/s, m/s, rad/s]: its scale and yaw factor times the true one
RowMotion row_motion(const Rigid3& T_robot_camera, const Eigen::Vector3d& odometry, double scale, double yaw_factor);

/// Residual of a corner, with its derivatives by the twist of the board when the middle row is read, by the motion's
/// twist, and by the readout.
struct RowResidual : CornerResidual {
  Eigen::Vector3d point_camera;  ///< when the corner's row is read
  RowJacobian<2, 6> by_motion;   ///< only where the motion bends views
  Eigen::Vector2d by_readout;
};
/// @param corner_camera when the middle row is read
/// Returns false where the point is not in front of the camera.
bool row_residual(const Camera& camera, const RowMotion& motion, const Eigen::Vector3d& corner_camera,
                  const Eigen::Vector2d& measured, RowResidual* residual);

}  // namespace rigproof::ml
