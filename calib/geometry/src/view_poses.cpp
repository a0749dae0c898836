#include "rigproof/calib/geometry/view_poses.h"

#include <map>

#include "rigproof/core/error_jacobians.h"

namespace rigproof {

Eigen::Vector3d camera_position_in_board(const Rigid3& T_camera_board) { return T_camera_board.inverse().translation; }

Eigen::Matrix3d camera_position_covariance(const ViewPose& view) {
  // d = -R^T t, and R' = Exp(phi) R gives delta d = -R^T (delta t + t x phi).
  const Eigen::Matrix3d R_board_camera = view.T_camera_board.rotation_matrix().transpose();
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), skew(view.T_camera_board.translation);
  J = R_board_camera * J;
  return J * view.covariance * J.transpose();
}

Matrix6d relative_covariance(const ViewPose& from, const ViewPose& to) {
  const RelativeJacobian J = relative_error_jacobian_of_inverses(from.T_camera_board, to.T_camera_board);
  const auto J_from = J.leftCols<6>(), J_to = J.rightCols<6>();
  return J_from * from.covariance * J_from.transpose() + J_to * to.covariance * J_to.transpose();
}

std::vector<std::vector<ViewPose>> by_board(const std::vector<ViewPose>& views, int boards) {
  std::vector<std::vector<ViewPose>> of_boards(static_cast<std::size_t>(boards));
  for (const ViewPose& view : views) of_boards[static_cast<std::size_t>(view.board)].push_back(view);
  return of_boards;
}

std::vector<ViewPair> consecutive_pairs(const std::vector<ViewPose>& views, int camera) {
  std::vector<ViewPair> pairs;
  std::map<int, const ViewPose*> last;  // of each board
  for (const ViewPose& view : views) {
    if (view.camera != camera) continue;
    const ViewPose*& previous = last[view.board];
    if (previous != nullptr && previous->stop != view.stop) pairs.push_back({previous, &view});
    previous = &view;
  }
  return pairs;
}

std::vector<Rigid3> odometry_poses(const Observations& observations) {
  std::vector<Rigid3> poses;
  poses.reserve(observations.stops.size());
  Rigid3 T_world_odom;
  for (const Stop& stop : observations.stops) {
    const Rigid3 T_odom_robot = planar_pose(stop.x_m, stop.y_m, stop.yaw_rad);
    if (poses.empty()) T_world_odom = T_odom_robot.inverse();
    poses.push_back(T_world_odom * T_odom_robot);
  }
  return poses;
}

}  // namespace rigproof
