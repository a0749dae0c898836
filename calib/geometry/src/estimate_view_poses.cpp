#include <algorithm>
#include <cmath>

#include "rigproof/calib/geometry/pnp.h"
#include "rigproof/calib/geometry/view_poses.h"

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
  return {view.camera, view.stop, view.file, Finding("view.no_pose", {{"corners", view.corners.size()}})};
}

}  // namespace

ViewPoses estimate_view_poses(const Observations& observations) {
  ViewPoses result;
  for (std::size_t i = 0; i < observations.board_views.size(); ++i) {
    const BoardView& view = observations.board_views[i];
    const Camera& camera = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    const std::optional<BoardPose> pose = estimate_board_pose(view.corners, observations.board_of(view), camera);
    if (!pose) {
      result.exclusions.push_back(no_pose(view));
      continue;
    }
    const double inflation = covariance_inflation(pose->reprojection_rms_px, expected_rms_px(view.corners));
    result.poses.push_back({static_cast<int>(i), view.stop, view.camera, pose->T_camera_board,
                            inflation * pose->covariance, pose->reprojection_rms_px, view.board});
  }
  return result;
}

}  // namespace rigproof
