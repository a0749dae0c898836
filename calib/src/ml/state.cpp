#include "ml/state.h"

#include <cmath>

namespace rigproof::ml {
namespace {

Rigid3 moved_transform(const Rigid3& T, const Eigen::Ref<const Vector6d>& step) {
  return Rigid3(T.rotation * so3_exp(step.tail<3>()), T.translation + step.head<3>());
}

}  // namespace

State state_from(const CalibrationState& values) {
  const std::size_t cameras = values.T_robot_camera.size();
  State state;
  state.T_robot_camera = values.T_robot_camera;
  state.T_world_board = values.T_world_board;
  for (const Rigid3& T : values.T_world_robot) state.poses.push_back(RobotPose::from_transform(T));
  state.odometry_scale = values.odometry_scale;
  state.odometry_yaw_factor = values.odometry_yaw_factor;
  for (const double scale : values.depth_scale) state.depth_bias.push_back(scale - 1.0);
  state.intrinsics.assign(cameras, Eigen::Vector3d::Zero());
  state.ground_offset.assign(cameras, Eigen::Vector3d::Zero());
  state.clock_offset_s.assign(cameras, 0.0);
  return state;
}

RobotPose RobotPose::from_transform(const Rigid3& T_world_robot) {
  RobotPose pose;
  pose.x_m = T_world_robot.translation.x();
  pose.y_m = T_world_robot.translation.y();
  pose.height_m = T_world_robot.translation.z();
  // The yaw that leaves a tilt without a component about z.
  pose.yaw_rad = wrap_angle(2.0 * std::atan2(T_world_robot.rotation.z(), T_world_robot.rotation.w()));
  const Eigen::Vector3d tilt = so3_log(rotation_z(-pose.yaw_rad) * T_world_robot.rotation);
  pose.roll_rad = tilt.x();
  pose.pitch_rad = tilt.y();
  return pose;
}

Layout Layout::of(const Observations& observations, const Priors& priors) {
  return {static_cast<int>(observations.stops.size()), static_cast<int>(observations.cameras.size()),
          priors.focal_relative > 0.0 || priors.principal_point_px > 0.0, !priors.ground_offset.empty(),
          priors.clock_offset_s > 0.0};
}

State moved(const State& state, const Layout& layout, const Eigen::VectorXd& pose_step,
            const Eigen::VectorXd& global_step) {
  State result = state;
  for (int i = 0; i < layout.poses; ++i) {
    RobotPose& pose = result.poses[static_cast<std::size_t>(i)];
    const auto step = pose_step.segment<6>(6 * i);
    pose.x_m += step[0];
    pose.y_m += step[1];
    pose.yaw_rad += step[2];
    pose.height_m += step[3];
    pose.roll_rad += step[4];
    pose.pitch_rad += step[5];
  }
  for (int c = 0; c < layout.cameras; ++c) {
    const std::size_t i = static_cast<std::size_t>(c);
    result.T_robot_camera[i] = moved_transform(state.T_robot_camera[i], global_step.segment<6>(layout.camera(c)));
    result.depth_bias[i] += global_step[layout.depth_bias(c)];
    if (layout.with_intrinsics) result.intrinsics[i] += global_step.segment<3>(layout.intrinsics(c));
    if (layout.with_clock_offsets) result.clock_offset_s[i] += global_step[layout.clock_offset(c)];
    if (layout.with_ground_offsets) result.ground_offset[i] += global_step.segment<3>(layout.ground_offset(c));
  }
  result.T_world_board = moved_transform(state.T_world_board, global_step.segment<6>(layout.board()));
  result.odometry_scale += global_step[layout.odometry_scale()];
  result.odometry_yaw_factor += global_step[layout.odometry_yaw_factor()];
  if (layout.with_clock_offsets) result.turn_lag_s += global_step[layout.turn_lag()];
  return result;
}

}  // namespace rigproof::ml
