// Pose of a planar board from its corners.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct BoardPose {
  Rigid3 T_camera_board;
  /// Covariance of the pose in the chart of transform_error(), from the corners' covariances.
  Matrix6d covariance = Matrix6d::Zero();
  double reprojection_rms_px = 0.0;
  /// Reprojection error of IPPE's second pose over that of this one; near 1 the view is ambiguous, infinite if the
  /// second pose is impossible.
  double ambiguity_ratio = 0.0;
};

/// IPPE on undistorted corners (Collins and Bartoli 2014), both solutions refined by weighted Gauss-Newton on the
/// reprojection error in the distorted image, the better one returned. Absent with fewer than four corners, corners
/// that no ray meets, or a solution behind the camera.
std::optional<BoardPose> estimate_board_pose(const std::vector<CornerObservation>& corners, const Board& board,
                                             const Camera& camera);

}  // namespace rigproof
