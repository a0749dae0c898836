#include "ml/contradictions.h"

#include <cmath>

#include "ml/sentence.h"
#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Robust chi-square per redundant dimension above which declared sigmas do not describe the data.
constexpr double kMaxChiSquare = 1.5;
// And by chance: this many standard deviations of it.
constexpr double kMaxDeviations = 5.0;
// Plausible levels: beyond them something else than noise is at work.
constexpr double kMaxOdometryXy_m = 0.10;
constexpr double kMaxOdometryYaw_rad = 0.15;
constexpr double kMaxCorner_px = 1.5;
// Systematic errors beyond these many sigmas of their prior.
constexpr double kMaxPriorSigmas = 3.0;

// Weighted squares over their expectation, or 0 where chance explains them.
double chi_square(const GroupSum& all, int loss_dimensions) {
  const GroupSum sum = all.without_outliers();
  const double redundancy = sum.redundancy();
  if (redundancy < 3.0) return 0.0;
  const double ratio = sum.weighted_square / (cauchy_moments(loss_dimensions).weighted_square * redundancy);
  return ratio > 1.0 + kMaxDeviations * std::sqrt(2.0 / redundancy) ? ratio : 0.0;
}

void check_declared(const Problem& problem, const GroupSums& sums, std::vector<std::string>* sentences) {
  const OdometryNoise& declared = problem.observations().odometry_noise;
  const double xy = declared.sigma_xy_m ? chi_square(sum_of(sums, Group::kOdometryXy), 3) : 0.0;
  const double yaw = declared.sigma_yaw_rad ? chi_square(sum_of(sums, Group::kOdometryYaw), 3) : 0.0;
  if (xy > kMaxChiSquare)
    sentences->push_back(format(
        "The odometry's translations contradict the cameras: %.1f times the declared %.2f mm (limit 1.2); another "
        "unit or frame, shifted stamps, or a board of another size.",
        std::sqrt(xy), 1e3 * *declared.sigma_xy_m));
  if (yaw > kMaxChiSquare)
    sentences->push_back(format(
        "The odometry's turns contradict the cameras: %.1f times the declared %.2f deg (limit 1.2); another unit, "
        "a mirrored frame, or shifted stamps.",
        std::sqrt(yaw), rad_to_deg(*declared.sigma_yaw_rad)));
}

void check_levels(const Problem& problem, std::vector<std::string>* sentences) {
  const NoiseLevels& noise = problem.noise;
  const OdometryNoise& declared = problem.observations().odometry_noise;
  const bool xy = !declared.sigma_xy_m && noise.odometry_xy_m > kMaxOdometryXy_m;
  const bool yaw = !declared.sigma_yaw_rad && noise.odometry_yaw_rad > kMaxOdometryYaw_rad;
  if (!xy && !yaw) return;
  sentences->push_back(format(
      "The odometry contradicts the cameras by %.0f mm and %.1f deg a stop (plausible: %.0f mm, %.1f deg); another "
      "unit or frame, or shifted stamps.",
      1e3 * noise.odometry_xy_m, rad_to_deg(noise.odometry_yaw_rad), 1e3 * kMaxOdometryXy_m,
      rad_to_deg(kMaxOdometryYaw_rad)));
}

// The loss hides what contradicts the cameras as outliers; when most of the odometry is hidden, it is no outlier.
void check_majority(const GroupSums& sums, std::vector<std::string>* sentences) {
  constexpr double kMinShare = 0.5;  // of the weight that Gaussian residuals have
  const GroupSum& sum = sum_of(sums, Group::kOdometryXy);
  if (sum.dimensions == 0 || sum.weight > kMinShare * cauchy_moments(3).weight * sum.dimensions) return;
  sentences->push_back(
      "Most of the odometry contradicts the cameras; another unit or frame, shifted stamps, or frames in another "
      "order.");
}

void check_systematics(const Problem& problem, const State& state, std::vector<std::string>* sentences) {
  if (problem.noise.odometry_model != OdometryModel::kPerIncrement) return;
  const Priors& priors = problem.priors();
  const auto beyond = [](double value, double sigma) {
    return sigma > 0.0 && std::abs(value - 1.0) > kMaxPriorSigmas * sigma;
  };
  if (beyond(state.odometry_scale, priors.odometry_scale))
    sentences->push_back(format(
        "The odometry's translations are %.3g times what the cameras see; another unit, a wrong wheel radius, or a "
        "board of another size.",
        state.odometry_scale));
  if (beyond(state.odometry_yaw_factor, priors.odometry_yaw_factor))
    sentences->push_back(format(
        "The odometry's turns are %.3g times what the cameras see; another unit, or a track without its skid factor.",
        state.odometry_yaw_factor));
}

// Median-like level of the corners in pixels: the scale times the stated sigma.
double corner_level_px(const Problem& problem, int camera) {
  double variance = 0.0;
  int count = 0;
  for (const BoardView& view : problem.observations().board_views) {
    if (view.camera != camera) continue;
    for (const CornerObservation& corner : view.corners) variance += 0.5 * corner.covariance_px2.trace();
    count += static_cast<int>(view.corners.size());
  }
  if (count == 0) return 0.0;
  return problem.noise.corner_scale[static_cast<std::size_t>(camera)] * std::sqrt(variance / count);
}

}  // namespace

Contradictions find_contradictions(const Problem& problem, const State& state, const GroupSums& sums) {
  Contradictions found;
  check_declared(problem, sums, &found.odometry);
  check_levels(problem, &found.odometry);
  check_majority(sums, &found.odometry);
  check_systematics(problem, state, &found.odometry);
  for (int c = 0; c < problem.layout().cameras; ++c) {
    const double level = corner_level_px(problem, c);
    found.bad_corners.push_back(level > kMaxCorner_px);
    if (level > kMaxCorner_px)
      found.cameras.push_back(format(
          "%s: corners are %.1f px off (plausible: %.1f px); intrinsics of another camera, an unmodelled lens, a bent "
          "board, or frames of another camera.",
          problem.observations().cameras[static_cast<std::size_t>(c)].name.c_str(), level, kMaxCorner_px));
  }
  return found;
}

}  // namespace rigproof::ml
