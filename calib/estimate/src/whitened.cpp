#include "rigproof/calib/estimate/whitened.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <map>
#include <utility>

#include "rigproof/calib/estimate/depth_bias.h"

namespace rigproof::ml {
namespace {

// By how much the image of a stop and camera is later than the stop, by the stamps.
class Delays {
 public:
  explicit Delays(const Observations& observations) {
    for (const BoardView& view : observations.board_views) {
      const Stop& at = observations.stops[static_cast<std::size_t>(view.stop)];
      if (!at.velocity.isZero(0.0)) seconds_.emplace(std::pair(view.stop, view.camera), view.stamp_s - at.stamp_s);
    }
  }
  double after(int stop, int camera) const {
    const auto found = seconds_.find({stop, camera});
    return found == seconds_.end() ? 0.0 : found->second;
  }

 private:
  std::map<std::pair<int, int>, double> seconds_;
};

std::vector<WhitenedView> whitened_views(const Observations& observations, const Delays& delays) {
  std::vector<WhitenedView> views;
  for (const BoardView& view : observations.board_views) {
    WhitenedView prepared{view.stop, view.camera, delays.after(view.stop, view.camera), {}};
    prepared.board = view.board;
    for (const WhitenedView::Corner& corner : whitened_corners(view, observations.board_of(view)))
      if (corner.whitening.allFinite() && corner.pixel.allFinite()) prepared.corners.push_back(corner);
    views.push_back(std::move(prepared));
  }
  return views;
}

// @param biases added to the planes' covariances [1/m^2]; empty: none
std::vector<WhitenedPlane> whitened_planes(const Observations& observations,
                                           const std::vector<PlaneObservation>& planes,
                                           const std::vector<Eigen::Matrix3d>& biases, const Delays& delays) {
  std::vector<WhitenedPlane> prepared;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneObservation& plane = planes[i];
    const Eigen::Matrix3d covariance = biases.empty() ? plane.covariance_per_m2 : plane.covariance_per_m2 + biases[i];
    const Eigen::Matrix3d L = covariance.llt().matrixL();
    const Eigen::Matrix3d whitening = L.inverse();
    if (!whitening.allFinite() || !plane.inverse_depth_plane.allFinite()) continue;
    prepared.push_back({plane.stop, plane.camera, delays.after(plane.stop, plane.camera), plane.inverse_depth_plane,
                        whitening, follows_lens(plane, observations.cameras[static_cast<std::size_t>(plane.camera)]),
                        mean_inverse_depth(plane)});
  }
  return prepared;
}

// The board that the camera sees at the plane's stop; of several boards a plane without a view is on none.
void keep_on_boards(const Observations& observations, std::vector<WhitenedPlane>* planes) {
  if (observations.more_boards.empty()) return;
  std::map<std::pair<int, int>, int> seen;
  for (const BoardView& view : observations.board_views) seen.emplace(std::pair(view.stop, view.camera), view.board);
  std::vector<WhitenedPlane> kept;
  for (WhitenedPlane& plane : *planes) {
    const auto board = seen.find({plane.stop, plane.camera});
    if (board == seen.end()) continue;
    plane.board = board->second;
    kept.push_back(plane);
  }
  *planes = std::move(kept);
}

}  // namespace

std::vector<WhitenedView::Corner> whitened_corners(const BoardView& view, const Board& board) {
  std::vector<WhitenedView::Corner> corners;
  corners.reserve(view.corners.size());
  for (const CornerObservation& corner : view.corners) {
    const Eigen::Matrix2d L = corner.covariance_px2.llt().matrixL();
    corners.push_back({corner.id, board.corner(corner.id), corner.pixel, L.inverse()});
  }
  return corners;
}

Whitened whitened(const Observations& observations) {
  const Delays delays(observations);
  Whitened all{
      whitened_views(observations, delays),
      whitened_planes(observations, observations.ground_planes, {}, delays),
      whitened_planes(observations, observations.board_planes, lasting_board_plane_biases(observations), delays),
      {}};
  keep_on_boards(observations, &all.board_planes);
  for (const RigCamera& camera : observations.cameras) all.lenses.emplace_back(camera.camera);
  return all;
}

Whitened with_corners_of(const Observations& observations, const Whitened& before) {
  return {whitened_views(observations, Delays(observations)), before.ground_planes, before.board_planes, before.lenses};
}

}  // namespace rigproof::ml
