// Board poses of all views: what every closed form and every motion-based method starts from.
#pragma once

#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// The board's pose in one camera at one stop.
struct ViewPose {
  int view = -1;  ///< index into Observations::board_views
  int stop = 0;
  int camera = 0;
  Rigid3 T_camera_board;
  /// Chart of transform_error(); inflated where the corners fit worse than their covariances say.
  Matrix6d covariance = Matrix6d::Identity();
  double reprojection_rms_px = 0.0;
  int board = 0;  ///< BoardView::board
};

/// The views of each board, each list as the views are.
std::vector<std::vector<ViewPose>> by_board(const std::vector<ViewPose>& views, int boards);

struct ViewPoses {
  std::vector<ViewPose> poses;  ///< sorted by (stop, camera)
  std::vector<Exclusion> exclusions;
};

/// PnP of every view (pnp.h). A view whose pose cannot be found becomes an exclusion.
ViewPoses estimate_view_poses(const Observations& observations);

/// Position of the camera in the board frame [m].
Eigen::Vector3d camera_position_in_board(const Rigid3& T_camera_board);
/// Covariance of that position from the covariance of the pose.
Eigen::Matrix3d camera_position_covariance(const ViewPose& view);

/// Covariance of T_from_to = T_from_board T_to_board^-1 from those of the two poses, in the same chart.
Matrix6d relative_covariance(const ViewPose& from, const ViewPose& to);

/// Two neighbouring views of one camera, in the order of driving: the motion that hand-eye equations are made of.
struct ViewPair {
  const ViewPose* from = nullptr;
  const ViewPose* to = nullptr;
};
/// Consecutive views of one camera, of one board, that belong to different stops.
std::vector<ViewPair> consecutive_pairs(const std::vector<ViewPose>& views, int camera);

/// T_world_robot by odometry alone; the world is the robot's frame at the first stop.
std::vector<Rigid3> odometry_poses(const Observations& observations);

}  // namespace rigproof
