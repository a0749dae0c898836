#include "rigproof/calib/estimate/whitened.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/calib/estimate/lens_change.h"

namespace rigproof::ml {
namespace {

// By how much the image of a camera is later than the stop, by the stamps.
double seconds_after_stop(const Observations& observations, int stop, int camera) {
  const Stop& at = observations.stops[static_cast<std::size_t>(stop)];
  if (at.velocity.isZero(0.0)) return 0.0;
  const std::vector<BoardView>& views = observations.board_views;
  const auto view = std::find_if(views.begin(), views.end(), [stop, camera](const BoardView& candidate) {
    return candidate.stop == stop && candidate.camera == camera;
  });
  return view == views.end() ? 0.0 : view->stamp_s - at.stamp_s;
}

std::vector<WhitenedView> whitened_views(const Observations& observations) {
  std::vector<WhitenedView> views;
  for (const BoardView& view : observations.board_views) {
    WhitenedView prepared{view.stop, view.camera, seconds_after_stop(observations, view.stop, view.camera), {}};
    for (const WhitenedView::Corner& corner : whitened_corners(view, observations.board))
      if (corner.whitening.allFinite() && corner.pixel.allFinite()) prepared.corners.push_back(corner);
    views.push_back(std::move(prepared));
  }
  return views;
}

// @param biases added to the planes' covariances [1/m^2]; empty: none
std::vector<WhitenedPlane> whitened_planes(const Observations& observations,
                                           const std::vector<PlaneObservation>& planes,
                                           const std::vector<Eigen::Matrix3d>& biases) {
  std::vector<WhitenedPlane> prepared;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneObservation& plane = planes[i];
    const Eigen::Matrix3d covariance = biases.empty() ? plane.covariance_per_m2 : plane.covariance_per_m2 + biases[i];
    const Eigen::Matrix3d L = covariance.llt().matrixL();
    const Eigen::Matrix3d whitening = L.inverse();
    if (!whitening.allFinite() || !plane.inverse_depth_plane.allFinite()) continue;
    prepared.push_back({plane.stop, plane.camera, seconds_after_stop(observations, plane.stop, plane.camera),
                        plane.inverse_depth_plane, whitening,
                        is_registered(plane, observations.cameras[static_cast<std::size_t>(plane.camera)])});
  }
  return prepared;
}

}  // namespace

std::vector<WhitenedView::Corner> whitened_corners(const BoardView& view, const Board& board) {
  std::vector<WhitenedView::Corner> corners;
  corners.reserve(view.corners.size());
  for (const CornerObservation& corner : view.corners) {
    const Eigen::Matrix2d L = corner.covariance_px2.llt().matrixL();
    corners.push_back({board.corner(corner.id), corner.pixel, L.inverse()});
  }
  return corners;
}

Whitened whitened(const Observations& observations) {
  return {whitened_views(observations), whitened_planes(observations, observations.ground_planes, {}),
          whitened_planes(observations, observations.board_planes, board_plane_biases(observations))};
}

}  // namespace rigproof::ml
