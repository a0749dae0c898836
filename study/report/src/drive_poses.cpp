#include "drive_poses.h"

#include "inspect_pictures.h"
#include "rigproof/calib/geometry/pnp.h"

namespace rigproof::inspect_detail {
namespace {

std::vector<Rigid3> odometry_of(const InspectInput& input) {
  std::vector<Rigid3> odometry;
  for (const Stop& stop : input.observations.stops) odometry.push_back(planar_pose(stop.x_m, stop.y_m, stop.yaw_rad));
  return odometry;
}

std::vector<Rigid3> driven_of(const InspectInput& input, const std::vector<Rigid3>& odometry) {
  std::vector<Rigid3> driven = odometry;
  for (std::size_t i = 0; input.truth && i < driven.size(); ++i)
    driven[i] = robot_at(*input.truth, input.observations.stops[i].stamp_s).value_or(odometry[i]);
  return driven;
}

// Odometry starts where it likes.
std::vector<Rigid3> aligned(std::vector<Rigid3> odometry, const Rigid3& first) {
  const Rigid3 T_world_odom =
      planar_pose(first.translation.x(), first.translation.y(), yaw_of(first)) * odometry[0].inverse();
  for (Rigid3& T : odometry) T = T_world_odom * T;
  return odometry;
}

std::optional<Rigid3> find_board(const InspectInput& input, const std::vector<Rigid3>& driven, int board) {
  if (input.truth && board < input.truth->boards()) return input.truth->board_at(board).T_world_board;
  for (const BoardView& view : input.observations.board_views) {
    if (view.board != board) continue;
    const RigCamera& camera = input.observations.cameras[static_cast<std::size_t>(view.camera)];
    const auto T_robot_camera = camera_pose(input, camera.name);
    if (!T_robot_camera) continue;
    const auto pose = estimate_board_pose(view.corners, input.observations.board_of(view), camera.camera);
    if (pose) return driven[static_cast<std::size_t>(view.stop)] * *T_robot_camera * pose->T_camera_board;
  }
  return std::nullopt;
}

}  // namespace

DrivePoses drive_poses(const InspectInput& input) {
  DrivePoses poses;
  poses.odometry = odometry_of(input);
  poses.driven = driven_of(input, poses.odometry);
  if (input.truth) poses.odometry = aligned(std::move(poses.odometry), poses.driven[0]);
  for (int b = 0; b < input.observations.boards(); ++b)
    poses.T_world_board.push_back(find_board(input, poses.driven, b));
  return poses;
}

}  // namespace rigproof::inspect_detail
