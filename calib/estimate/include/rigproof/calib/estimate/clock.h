// Images whose stamps differ from the stop's: the robot's pose when they were taken.
#pragma once

#include <Eigen/Core>

#include "rigproof/calib/estimate/residuals.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// What the odometry says of a stop: velocity and acceleration in the robot's frame [m, rad, s].
struct OdometryMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero(), acceleration = Eigen::Vector3d::Zero();

  explicit OdometryMotion(const Stop& stop) : velocity(stop.velocity), acceleration(stop.acceleration) {}
  bool stands() const { return velocity.isZero(0.0); }
  /// So much later.
  Eigen::Vector3d velocity_after(double dt_s) const { return velocity + dt_s * acceleration; }
};

/// The pose of a stop, moved along the odometry's motion to the time at which an image was taken. The suspension's
/// slack stays.
struct PoseAtImage {
  RobotPose pose;
  Eigen::Vector2d xy_by_yaw = Eigen::Vector2d::Zero();  ///< of the stop
  Eigen::Matrix<double, 3, 2> by_times =
      Eigen::Matrix<double, 3, 2>::Zero();  ///< (x, y, yaw) by clock offset, turn lag
  Eigen::Matrix<double, 3, 2> by_factors = Eigen::Matrix<double, 3, 2>::Zero();  ///< by odometry's scale, yaw factor
};

/// @param late_s by how much the stop's stamp is later than the image was taken
/// @param turn_lag_s by how much the body turns later than the odometry's wheels
PoseAtImage pose_at_image(const RobotPose& stop, const OdometryMotion& motion, double late_s, double turn_lag_s,
                          double odometry_scale, double odometry_yaw_factor);

/// Twist of the board in the camera by (odometry scale, yaw factor), by the clock offset and by the turn lag.
struct ClockTwist {
  Eigen::Matrix<double, 6, 2> by_factors;
  Vector6d by_clock_offset, by_turn_lag;
};
/// Chains the view's derivatives, made at the image's pose, to the stop's pose.
ClockTwist chain_to_stop(const PoseAtImage& at_image, ViewGeometry* geometry);

}  // namespace rigproof::ml
