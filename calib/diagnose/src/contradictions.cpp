#include "contradictions.h"

#include <algorithm>
#include <cmath>

#include "rigproof/calib/estimate/solver.h"
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
constexpr int kOdometryDimensions = 3;  // of a residual

// Weighted squares over their expectation, or 0 where chance explains them.
double chi_square(const GroupSum& all) {
  const GroupSum sum = all.without_outliers();
  const double redundancy = sum.redundancy();
  if (redundancy < 3.0) return 0.0;
  const double ratio = sum.weighted_square / (cauchy_moments(kOdometryDimensions).weighted_square * redundancy);
  return ratio > std::max(kMaxChiSquare, 1.0 + kMaxDeviations * std::sqrt(2.0 / redundancy)) ? ratio : 0.0;
}

// Square of the odometry's residuals over what its declared sigmas expect.
std::vector<Finding> check_declared(const OdometryNoise& declared, const GroupSums& sums) {
  std::vector<Finding> findings;
  if (const double ratio = declared.sigma_xy_m ? chi_square(sum_of(sums, Group::kOdometryXy)) : 0.0; ratio > 0.0)
    findings.emplace_back("odometry.translations_contradict",
                          FindingValues{{"ratio", std::sqrt(ratio)}, {"declared_mm", 1e3 * *declared.sigma_xy_m}});
  if (const double ratio = declared.sigma_yaw_rad ? chi_square(sum_of(sums, Group::kOdometryYaw)) : 0.0; ratio > 0.0)
    findings.emplace_back(
        "odometry.turns_contradict",
        FindingValues{{"ratio", std::sqrt(ratio)}, {"declared_deg", rad_to_deg(*declared.sigma_yaw_rad)}});
  return findings;
}

void check_levels(const Problem& problem, std::vector<Finding>* findings) {
  const NoiseLevels& noise = problem.noise;
  const OdometryNoise& declared = problem.observations().odometry_noise;
  const bool xy = !declared.sigma_xy_m && noise.odometry_xy_m > kMaxOdometryXy_m;
  const bool yaw = !declared.sigma_yaw_rad && noise.odometry_yaw_rad > kMaxOdometryYaw_rad;
  if (!xy && !yaw) return;
  findings->emplace_back("odometry.implausible", FindingValues{{"off_mm", 1e3 * noise.odometry_xy_m},
                                                               {"off_deg", rad_to_deg(noise.odometry_yaw_rad)},
                                                               {"limit_mm", 1e3 * kMaxOdometryXy_m},
                                                               {"limit_deg", rad_to_deg(kMaxOdometryYaw_rad)}});
}

// The loss hides what contradicts the cameras as outliers; when most of the odometry is hidden, it is no outlier.
void check_majority(const GroupSums& sums, std::vector<Finding>* findings) {
  constexpr double kMinShare = 0.5;  // of the weight that Gaussian residuals have
  const GroupSum& sum = sum_of(sums, Group::kOdometryXy);
  if (sum.dimensions == 0 || sum.weight > kMinShare * cauchy_moments(kOdometryDimensions).weight * sum.dimensions)
    return;
  findings->emplace_back("odometry.mostly_outliers");
}

void check_systematics(const Problem& problem, const State& state, std::vector<Finding>* findings) {
  if (problem.noise.law.model != OdometryModel::kPerIncrement) return;
  const auto beyond = [&](Nuisance nuisance, int part) {
    const double sigma = problem.priors().sigma(nuisance, 0, part);
    return sigma > 0.0 && std::abs(state.nuisances.of(nuisance)[part]) > kMaxPriorSigmas * sigma;
  };
  if (beyond(Nuisance::kOdometryFactors, 0))
    findings->emplace_back("odometry.translation_factor", FindingValues{{"factor", state.odometry_scale()}});
  if (beyond(Nuisance::kOdometryFactors, 1))
    findings->emplace_back("odometry.turn_factor", FindingValues{{"factor", state.odometry_yaw_factor()}});
  if (beyond(Nuisance::kOdometryVeer, 0))
    findings->emplace_back("odometry.veers_far", FindingValues{{"deg_per_m", rad_to_deg(state.odometry_veer())}});
}

}  // namespace

Contradictions find_contradictions(const Problem& problem, const State& state, const GroupSums& sums) {
  Contradictions found;
  for (int c = 0; c < problem.layout().cameras; ++c) {
    const auto camera = static_cast<std::size_t>(c);
    const double scale = problem.noise.corner_scale[camera] / problem.noise.shaken[camera];
    const double level = scale * stated_corner_px(problem.observations(), c);
    found.bad_corners.push_back(level > kMaxCorner_px);
    if (level > kMaxCorner_px)
      found.cameras.push_back(Finding("corners.off", {{"off_px", level}, {"limit_px", kMaxCorner_px}})
                                  .of(problem.observations().cameras[camera].name));
  }
  found.odometry = check_declared(problem.observations().odometry_noise, sums);
  check_levels(problem, &found.odometry);
  check_majority(sums, &found.odometry);
  check_systematics(problem, state, &found.odometry);
  return found;
}

}  // namespace rigproof::ml
