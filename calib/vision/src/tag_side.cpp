#include "tag_side.h"

#include <Eigen/Core>

#include "rigproof/calib/geometry/homography.h"

namespace rigproof::detection {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// Corners of a view as seen along undistorted rays, and how they differ from the best plane view of the board.
std::optional<VectorXd> off_plane(const Board& board, const Camera& camera, const BoardView& view) {
  std::vector<PlanePoint> points;
  for (const CornerObservation& corner : view.corners) {
    Eigen::Vector3d ray;
    if (!camera.unproject(corner.pixel, &ray) || !(ray.z() > 0.0)) return std::nullopt;
    points.push_back({board.corner(corner.id).head<2>() / board.square_m, ray.hnormalized()});
  }
  const std::optional<Homography> H = Homography::fit(points);
  if (!H) return std::nullopt;
  VectorXd off(static_cast<Eigen::Index>(2 * points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vector2d expected;
    if (!H->map(points[i].board, &expected)) return std::nullopt;
    off.segment<2>(static_cast<Eigen::Index>(2 * i)) = points[i].pixel - expected;
  }
  return off;
}

}  // namespace

std::optional<double> tag_share_in(const Observations& observations, int index) {
  constexpr double kStep = 1e-3;  // of the share; what is seen is linear in it to a thousandth of that
  const double stated = observations.board_at(index).marker_side_m() / observations.board_at(index).square_m;
  const auto with = [&](double share) {
    Board board = observations.board_at(index);
    board.marker_m = share * board.square_m;
    return board;
  };
  const Board low = with(stated - kStep), high = with(stated + kStep);
  double squares = 0.0, product = 0.0;
  for (const BoardView& view : observations.board_views) {
    if (view.board != index) continue;
    const Camera& camera = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    const auto below = off_plane(low, camera, view), above = off_plane(high, camera, view);
    if (!below || !above) continue;
    // Homographies have taken up all that they can: what is left is of the share.
    const VectorXd slope = (*above - *below) / (2.0 * kStep), off = 0.5 * (*above + *below);
    const double per_px = camera.fx_px * camera.fx_px;  // pixels count alike
    squares += per_px * slope.squaredNorm();
    product += per_px * slope.dot(off);
  }
  constexpr double kLeastPx = 1.0;  // that a change of the share by a hundredth makes, over all corners
  if (!(squares > kLeastPx * kLeastPx * 1e4)) return std::nullopt;
  return stated - product / squares;
}

}  // namespace rigproof::detection
