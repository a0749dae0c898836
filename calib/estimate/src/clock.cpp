#include "rigproof/calib/estimate/clock.h"

#include <cmath>

namespace rigproof::ml {

PoseAtImage pose_at_image(const RobotPose& stop, const Eigen::Vector3d& velocity, double late_s, double turn_lag_s,
                          double odometry_scale, double odometry_yaw_factor) {
  const double c = std::cos(stop.yaw_rad), s = std::sin(stop.yaw_rad);
  const Eigen::Vector2d forward = velocity.head<2>() / odometry_scale;
  const Eigen::Vector2d in_world(c * forward.x() - s * forward.y(), s * forward.x() + c * forward.y());
  const double turning = velocity.z() / odometry_yaw_factor;
  PoseAtImage at_image;
  at_image.pose = stop;
  at_image.pose.x_m -= late_s * in_world.x();
  at_image.pose.y_m -= late_s * in_world.y();
  at_image.pose.yaw_rad -= (late_s + turn_lag_s) * turning;
  at_image.xy_by_yaw = late_s * Eigen::Vector2d(in_world.y(), -in_world.x());
  at_image.by_times.col(0) << -in_world, -turning;
  at_image.by_times.col(1) << 0.0, 0.0, -turning;
  at_image.by_factors.col(0) << late_s / odometry_scale * in_world, 0.0;
  at_image.by_factors.col(1) << 0.0, 0.0, (late_s + turn_lag_s) / odometry_yaw_factor * turning;
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
