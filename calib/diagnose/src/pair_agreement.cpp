#include "pair_agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/median.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::ml {
namespace {

constexpr std::size_t kFewest = 4;  // common stops by which two cameras are judged
// What lenses and stamps that are a little off leave of poses by PnP, beside the corners' noise.
constexpr double kLeast_m = 0.005, kLeast_rad = 0.005;
// What is farther from the middle one than this many times what half of them are, or than this many deviations, differs
// from the others. Where half of them are farther than kMostOfHalf deviations, there is nothing that they agree on.
constexpr double kDiffers = 4.0, kMostOfHalf = 3.0;
// Of the frames of a camera that the others vouch for, one in so many may differ.
constexpr std::ptrdiff_t kOneIn = 8;

struct Relative {
  int stop = 0;
  Rigid3 T_first_second;
  Matrix6d covariance;
};

std::vector<Relative> relative_poses(const std::vector<ViewPose>& views, int first, int second) {
  std::vector<Relative> poses;
  const ViewPose* seen_by_first = nullptr;
  for (const ViewPose& view : views) {  // by stop and camera, and `first` comes before `second`
    if (view.camera == first) seen_by_first = &view;
    if (view.camera != second || seen_by_first == nullptr || seen_by_first->stop != view.stop ||
        seen_by_first->board != view.board)
      continue;
    poses.push_back({view.stop, seen_by_first->T_camera_board * view.T_camera_board.inverse(),
                     relative_covariance(*seen_by_first, view)});
  }
  return poses;
}

// In standard deviations, of the mean degree of freedom.
double distance(const Relative& a, const Relative& b) {
  Vector6d least;
  least << Eigen::Vector3d::Constant(kLeast_m * kLeast_m), Eigen::Vector3d::Constant(kLeast_rad * kLeast_rad);
  const Matrix6d covariance = a.covariance + b.covariance + Matrix6d(least.asDiagonal());
  const Vector6d error = transform_error(a.T_first_second, b.T_first_second);
  return std::sqrt(error.dot(covariance.ldlt().solve(error)) / 6.0);
}

// Of each to the one that is nearest to half of them.
std::vector<double> distances_to_middle(const std::vector<Relative>& poses) {
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Relative& middle : poses) {
    std::vector<double> distances;
    for (const Relative& pose : poses) distances.push_back(distance(pose, middle));
    const double half = median(distances);
    if (half >= least) continue;
    least = half;
    best = std::move(distances);
  }
  return best;
}

std::vector<int> stops_that_agree(const std::vector<Relative>& poses) {
  if (poses.size() < kFewest) return {};
  const std::vector<double> distances = distances_to_middle(poses);
  const double half = median(distances);
  if (half > kMostOfHalf) return {};
  const double most = kDiffers * std::max(1.0, half);
  std::vector<int> stops;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (distances[i] <= most) stops.push_back(poses[i].stop);
  return stops;
}

}  // namespace

PairAgreement::PairAgreement(const Observations& observations) {
  const std::vector<ViewPose> views = estimate_view_poses(observations).poses;
  const std::size_t cameras = observations.cameras.size();
  agrees_.assign(cameras, std::vector<bool>(observations.stops.size(), false));
  for (std::size_t a = 0; a < cameras; ++a)
    for (std::size_t b = a + 1; b < cameras; ++b)
      for (const int stop : stops_that_agree(relative_poses(views, static_cast<int>(a), static_cast<int>(b))))
        agrees_[a][static_cast<std::size_t>(stop)] = agrees_[b][static_cast<std::size_t>(stop)] = true;
  std::vector<std::ptrdiff_t> frames(cameras, 0);
  for (const BoardView& view : observations.board_views) ++frames[static_cast<std::size_t>(view.camera)];
  for (std::size_t c = 0; c < cameras; ++c) {
    const auto agreeing = std::count(agrees_[c].begin(), agrees_[c].end(), true);
    nearly_all_agree_.push_back(agreeing > 0 && kOneIn * (frames[c] - agreeing) <= frames[c]);
  }
}

bool PairAgreement::vouches_for(int camera, int stop) const {
  return agrees_[static_cast<std::size_t>(camera)][static_cast<std::size_t>(stop)];
}

bool PairAgreement::vouches_for(int camera) const { return nearly_all_agree_[static_cast<std::size_t>(camera)]; }

}  // namespace rigproof::ml
