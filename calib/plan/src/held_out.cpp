// Images that are left out and predicted by the others.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/plan/accept.h"
#include "used_observations.h"

namespace rigproof {
namespace {

constexpr double kLossC2 = 9.0;  // of ml's loss, c = 3

// What a block of whitened Gaussian residuals of 2 or 3 dimensions adds to the cost: the mean of the loss under
// chi-square, by Simpson's rule. Both densities are smooth in sqrt(s).
double expected_cost(int dimensions) {
  constexpr int kSteps = 2000;
  constexpr double kEnd = 12.0;  // of sqrt(s): beyond lies e^-72
  const double normalisation = dimensions == 2 ? 1.0 : std::sqrt(2.0 / std::acos(-1.0));
  const auto integrand = [&](double root) {
    const double s = root * root;
    return kLossC2 * std::log1p(s / kLossC2) * normalisation * std::pow(root, dimensions - 1) * std::exp(-0.5 * s);
  };
  double sum = integrand(0.0) + integrand(kEnd);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * integrand(kEnd * i / kSteps);
  return sum * kEnd / kSteps / 3.0;
}

// Observations with the noise levels that were estimated, so that every later solution has the same.
Observations with_levels(Observations observations, const MlEstimate& estimate) {
  observations.odometry_noise.model = estimate.noise.law.model;
  observations.odometry_noise.sigma_xy_m = estimate.noise.odometry_xy_m;
  observations.odometry_noise.sigma_yaw_rad = estimate.noise.odometry_yaw_rad;
  const auto squared = [](const std::vector<double>& scale, int camera) {
    return std::pow(scale[static_cast<std::size_t>(camera)], 2);
  };
  for (BoardView& view : observations.board_views)
    for (CornerObservation& corner : view.corners) corner.covariance_px2 *= squared(estimate.corner_scale, view.camera);
  for (PlaneObservation& plane : observations.ground_planes)
    plane.covariance_per_m2 *= squared(estimate.ground_scale, plane.camera);
  for (PlaneObservation& plane : observations.board_planes)
    plane.covariance_per_m2 *= squared(estimate.board_plane_scale, plane.camera);
  return observations;
}

// As it was found, beside corners that are stated to be as noisy as they are.
std::shared_ptr<const ml::RemovedErrors> beside_levels(ml::RemovedErrors repeating) {
  for (ml::RemovedErrors::Fine& fine : repeating.fine) fine.noise = 1.0;
  return std::make_shared<const ml::RemovedErrors>(std::move(repeating));
}

struct Fold {
  Observations rest;  ///< all stops and the odometry, without the images of those that are left out
  double expected = 0.0;
  int stops = 0;
};

template <typename Item, typename Count>
void leave_out(int fold, int folds, std::vector<Item>* items, const Count& count) {
  const auto left_out = [fold, folds](const Item& item) { return item.stop % folds == fold; };
  std::for_each(items->begin(), items->end(), [&](const Item& item) {
    if (left_out(item)) count(item);
  });
  items->erase(std::remove_if(items->begin(), items->end(), left_out), items->end());
}

Fold make_fold(const Observations& observations, int fold, int folds) {
  static const double corner = expected_cost(2), plane = expected_cost(3);
  Fold result{observations, 0.0, 0};
  const auto count_plane = [&result](const PlaneObservation&) { result.expected += plane; };
  leave_out(fold, folds, &result.rest.board_views,
            [&result](const BoardView& view) { result.expected += corner * static_cast<double>(view.corners.size()); });
  leave_out(fold, folds, &result.rest.ground_planes, count_plane);
  leave_out(fold, folds, &result.rest.board_planes, count_plane);
  const int stops = static_cast<int>(observations.stops.size());
  result.stops = (stops - fold + folds - 1) / folds;
  return result;
}

}  // namespace

std::optional<HeldOut> predict_held_out(const Observations& observations, int folds, const MlOptions& asked) {
  constexpr int kLeastStops = 4;
  const int stops = static_cast<int>(observations.stops.size());
  if (stops < kLeastStops || folds < 2) return std::nullopt;
  folds = std::min(folds, stops);
  const MlEstimate estimate = estimate_maximum_likelihood(observations, asked);
  if (estimate.result.status != ResultStatus::kSolved) return std::nullopt;
  const std::vector<ViewPose> views = estimate_view_poses(observations).poses;
  const GroundCheck ground = check_ground_planes(observations, align_trajectories(observations, views));
  const Observations all = with_levels(used_observations(estimate.result, observations, ground), estimate);
  MlOptions options = asked;
  options.along_way = estimate.noise.law.along_way;
  options.metre_as_turn_rad = estimate.noise.law.metre_as_turn_rad;
  options.start = estimate.state;
  options.estimate_corner_level = options.estimate_plane_level = false;
  if (estimate.repeating) options.repeating = beside_levels(*estimate.repeating);
  options.suspension_height_sigma_m = estimate.noise.suspension_height_m;
  options.suspension_tilt_sigma_rad = estimate.noise.suspension_tilt_rad;
  options.displacement_scale = estimate.displacement_scale;
  const double cost = estimate_maximum_likelihood(all, options).cost;
  // What the images that were left out add to the least cost is the square of what the others did not foresee of them,
  // whitened by the uncertainty of the forecast.
  HeldOut held_out;
  for (int i = 0; i < folds; ++i) {
    const Fold fold = make_fold(all, i, folds);
    if (!(fold.expected > 0.0)) continue;
    const MlEstimate rest = estimate_maximum_likelihood(fold.rest, options);
    if (rest.state.T_robot_camera.empty()) return std::nullopt;
    held_out.chi_square += std::max(0.0, cost - rest.cost);
    held_out.expected += fold.expected;
    held_out.stops += fold.stops;
  }
  if (!(held_out.expected > 0.0)) return std::nullopt;
  return held_out;
}

}  // namespace rigproof
