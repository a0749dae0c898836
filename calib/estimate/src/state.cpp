#include "rigproof/calib/estimate/state.h"

#include <cmath>

namespace rigproof::ml {
namespace {

Rigid3 moved_transform(const Rigid3& T, const Eigen::Ref<const Vector6d>& step) {
  return Rigid3(T.rotation * so3_exp(step.tail<3>()), T.translation + step.head<3>());
}

}  // namespace

State state_from(const CalibrationState& values) {
  State state;
  state.T_robot_camera = values.T_robot_camera;
  state.T_world_board = values.T_world_more_boards;
  state.T_world_board.insert(state.T_world_board.begin(), values.T_world_board);
  for (const Rigid3& T : values.T_world_robot) state.poses.push_back(RobotPose::from_transform(T));
  state.nuisances =
      NuisanceValues(static_cast<int>(values.T_robot_camera.size()), static_cast<int>(state.T_world_board.size()));
  state.nuisances.of(Nuisance::kOdometryFactors) << values.odometry_scale - 1.0, values.odometry_yaw_factor - 1.0;
  for (std::size_t c = 0; c < values.depth_scale.size(); ++c)
    state.nuisances.of(Nuisance::kDepthScale, static_cast<int>(c))[0] = values.depth_scale[c] - 1.0;
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
  Layout layout;
  layout.poses = static_cast<int>(observations.stops.size());
  layout.cameras = static_cast<int>(observations.cameras.size());
  layout.boards = observations.boards();
  layout.globals_ = 6 * (layout.cameras + layout.boards);
  for (std::size_t n = 0; n < kNuisances; ++n) {
    const Nuisance nuisance = static_cast<Nuisance>(n);
    layout.first_[n] = priors.has(nuisance) ? layout.globals_ : -1;
    if (layout.has(nuisance)) layout.globals_ += priors.count(nuisance) * row_of(nuisance).size();
  }
  return layout;
}

void Layout::add(const Step& step) {
  step_ = step;
  globals_ += 6 * static_cast<int>(step.bodies.size());
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
  }
  for (int b = 0; b < layout.boards; ++b) {
    const std::size_t i = static_cast<std::size_t>(b);
    result.T_world_board[i] = moved_transform(state.T_world_board[i], global_step.segment<6>(layout.board(b)));
  }
  for (std::size_t i = 0; i < state.second_poses.size(); ++i)
    result.second_poses[i] =
        moved_transform(state.second_poses[i], global_step.segment<6>(layout.second(static_cast<int>(i))));
  for (std::size_t n = 0; n < kNuisances; ++n) {
    const Nuisance nuisance = static_cast<Nuisance>(n);
    for (int c = 0; layout.has(nuisance) && c < layout.count(nuisance); ++c)
      result.nuisances.of(nuisance, c) += global_step.segment(layout.place(nuisance, c), row_of(nuisance).size());
  }
  return result;
}

}  // namespace rigproof::ml
