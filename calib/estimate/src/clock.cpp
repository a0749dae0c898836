#include "rigproof/calib/estimate/clock.h"

#include <cmath>

namespace rigproof::ml {

PoseAtImage pose_at_image(const RobotPose& stop, const OdometryMotion& motion, double late_s, double turn_lag_s,
                          double odometry_scale, double odometry_yaw_factor) {
  const double c = std::cos(stop.yaw_rad), s = std::sin(stop.yaw_rad);
  const auto in_world = [&](const Eigen::Vector3d& of_odometry) -> Eigen::Vector2d {
    const Eigen::Vector2d forward = of_odometry.head<2>() / odometry_scale;
    return {c * forward.x() - s * forward.y(), s * forward.x() + c * forward.y()};
  };
  // On the way between the stop and the image, and at the image.
  const Eigen::Vector3d mean = motion.velocity_after(-0.5 * late_s), then = motion.velocity_after(-late_s);
  const Eigen::Vector2d moving = in_world(mean);
  const double yaw_late_s = late_s + turn_lag_s;
  const double turning = motion.velocity_after(-0.5 * yaw_late_s).z() / odometry_yaw_factor;
  const double turning_then = motion.velocity_after(-yaw_late_s).z() / odometry_yaw_factor;
  PoseAtImage at_image;
  at_image.pose = stop;
  at_image.pose.x_m -= late_s * moving.x();
  at_image.pose.y_m -= late_s * moving.y();
  at_image.pose.yaw_rad -= yaw_late_s * turning;
  at_image.xy_by_yaw = late_s * Eigen::Vector2d(moving.y(), -moving.x());
  at_image.by_times.col(0) << -in_world(then), -turning_then;
  at_image.by_times.col(1) << 0.0, 0.0, -turning_then;
  at_image.by_factors.col(0) << late_s / odometry_scale * moving, 0.0;
  at_image.by_factors.col(1) << 0.0, 0.0, yaw_late_s / odometry_yaw_factor * turning;
  return at_image;
}

ClockTwist chain_to_stop(const PoseAtImage& at_image, ViewGeometry* geometry) {
  const auto by_planar = geometry->twist_by_pose.leftCols<3>();
  ClockTwist twist;
  twist.by_factors = by_planar * at_image.by_factors;
  twist.by_clock_offset = by_planar * at_image.by_times.col(0);
  twist.by_turn_lag = by_planar * at_image.by_times.col(1);
  geometry->twist_by_pose.col(2) += geometry->twist_by_pose.leftCols<2>() * at_image.xy_by_yaw;
  return twist;
}

}  // namespace rigproof::ml
