#include "rigproof/calib/view_poses.h"

#include <algorithm>
#include <cmath>

#include "rigproof/calib/pnp.h"

namespace rigproof {
namespace {

// Expected rms of the reprojection error: corners' own noise, less the six parameters that were fitted.
double expected_rms_px(const std::vector<CornerObservation>& corners) {
  double variance = 0.0;
  for (const CornerObservation& corner : corners) variance += corner.covariance_px2.trace();
  const double count = static_cast<double>(corners.size());
  const double freedom = std::max(2.0, 2.0 * count - 6.0) / (2.0 * count);
  return std::sqrt(freedom * variance / count);
}

// Corners that fit worse than they claim to (lens, print, a slipped corner) make the pose as much less certain.
double covariance_inflation(double rms_px, double expected_px) {
  if (!(expected_px > 0.0)) return 1.0;
  const double ratio = rms_px / expected_px;
  return std::max(1.0, ratio * ratio);
}

Exclusion no_pose(const BoardView& view) {
  return {view.camera, view.stop, view.file, "no board pose from " + std::to_string(view.corners.size()) + " corners"};
}

}  // namespace

ViewPoses estimate_view_poses(const Observations& observations) {
  ViewPoses result;
  for (std::size_t i = 0; i < observations.board_views.size(); ++i) {
    const BoardView& view = observations.board_views[i];
    const Camera& camera = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    const std::optional<BoardPose> pose = estimate_board_pose(view.corners, observations.board, camera);
    if (!pose) {
      result.exclusions.push_back(no_pose(view));
      continue;
    }
    const double inflation = covariance_inflation(pose->reprojection_rms_px, expected_rms_px(view.corners));
    result.poses.push_back({static_cast<int>(i), view.stop, view.camera, pose->T_camera_board,
                            inflation * pose->covariance, pose->reprojection_rms_px});
  }
  return result;
}

Eigen::Vector3d camera_position_in_board(const Rigid3& T_camera_board) { return T_camera_board.inverse().translation; }

Eigen::Matrix3d camera_position_covariance(const ViewPose& view) {
  // d = -R^T t, and R' = Exp(phi) R gives delta d = -R^T (delta t + t x phi).
  const Eigen::Matrix3d R_board_camera = view.T_camera_board.rotation_matrix().transpose();
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), skew(view.T_camera_board.translation);
  J = R_board_camera * J;
  return J * view.covariance * J.transpose();
}

std::vector<ViewPair> consecutive_pairs(const std::vector<ViewPose>& views, int camera) {
  std::vector<ViewPair> pairs;
  const ViewPose* previous = nullptr;
  for (const ViewPose& view : views) {
    if (view.camera != camera) continue;
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
