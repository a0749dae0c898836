// The pose of one camera in another, from stops at which both saw the board: needs neither odometry nor motion.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// The board as two cameras saw it at one stop.
struct SharedView {
  const ViewPose *j, *k;
};
/// In the order of driving. The views must outlive what is returned.
std::vector<SharedView> shared_views(const std::vector<ViewPose>& views, int camera_j, int camera_k);

struct SharedViewTransform {
  Rigid3 T_j_k;
  Matrix6d covariance = Matrix6d::Zero();  ///< chart of transform_error()
  int stops = 0;
};

/// Information-weighted robust mean of T_j_board T_k_board^-1; absent without a common stop.
std::optional<SharedViewTransform> transform_from_shared_views(const std::vector<ViewPose>& views, int camera_j,
                                                               int camera_k);

}  // namespace rigproof
