#include "rigproof/calib/estimate/stated_levels.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rigproof::ml {
namespace {

// The usual ones. Along the way, heading is lost as much by a drive of a metre for each radian, whatever loses it.
NoiseLevels nominal_levels(const OdometryLaw& law) {
  NoiseLevels levels;
  if (law.along_way)
    levels.odometry_yaw_rad *= std::sqrt((1.0 + OdometryLaw().metre_as_turn_rad) / (1.0 + law.metre_as_turn_rad));
  return levels;
}

// The level of a group by which uncertainty is stated. An estimated level is itself uncertain: with few redundant
// dimensions its square, as Student's t says, must be taken nu / (nu - 2) times larger. With next to none, the
// odometry is far better than the cameras, or there is nearly nothing of it: then the level at which the data would
// have told it from less, and at most the paper's nominal one.
void allow_for_estimation(const Preparation& prepared, const Fit& fit, Group group, const GroupSums& sums,
                          double NoiseLevels::*level, double nominal, NoiseLevels* levels) {
  constexpr double kNextToNone = 4.0, kSure = 8.0;
  double& sigma = levels->*level;
  const double redundancy = sum_of(sums, group).redundancy();
  if (redundancy > kNextToNone) {
    sigma *= std::sqrt(redundancy / (redundancy - 2.0));
    return;
  }
  const auto redundancy_at = [&](double trial) {
    NoiseLevels tried = fit.noise;
    tried.*level = trial;
    const std::optional<GroupSums> at = problem_at(prepared, fit, tried).sums_with_leverage(fit.state);
    return at ? sum_of(*at, group).redundancy() : 0.0;
  };
  double low = sigma, high = std::max(sigma, nominal);
  if (redundancy_at(high) < kSure) {
    sigma = high * std::sqrt(kNextToNone / (kNextToNone - 2.0));
    return;
  }
  for (int halving = 0; halving < 6; ++halving) {
    const double middle = std::sqrt(low * high);
    (redundancy_at(middle) < kSure ? low : high) = middle;
  }
  sigma = high;
}

// Planes of one or two stops agree by chance as if there were no noise. What is stated of them counts with as many
// dimensions as these; where they scatter more than stated, that holds.
void allow_for_few_planes(const GroupSums& sums, Group group, std::vector<double>* scales) {
  constexpr double kStatedDimensions = 8.0;
  for (std::size_t c = 0; c < scales->size(); ++c) {
    double& scale = (*scales)[c];
    const double redundancy = std::max(0.0, sum_of(sums, group, static_cast<int>(c)).redundancy());
    if (scale < 1.0)
      scale = std::sqrt((redundancy * scale * scale + kStatedDimensions) / (redundancy + kStatedDimensions));
  }
}

}  // namespace

NoiseLevels stated_levels(const Preparation& prepared, const Fit& fit, const GroupSums& sums) {
  NoiseLevels levels = fit.noise;
  const NoiseLevels nominal = nominal_levels(fit.noise.law);
  if (!prepared.original.odometry_noise.sigma_xy_m)
    allow_for_estimation(prepared, fit, Group::kOdometryXy, sums, &NoiseLevels::odometry_xy_m, nominal.odometry_xy_m,
                         &levels);
  if (!prepared.original.odometry_noise.sigma_yaw_rad)
    allow_for_estimation(prepared, fit, Group::kOdometryYaw, sums, &NoiseLevels::odometry_yaw_rad,
                         nominal.odometry_yaw_rad, &levels);
  if (prepared.options.estimate_plane_level) {
    allow_for_few_planes(sums, Group::kGround, &levels.ground_scale);
    allow_for_few_planes(sums, Group::kBoardPlane, &levels.board_plane_scale);
  }
  return levels;
}

// Whether an answer is of use is judged by the odometry's level as it most likely is, not by how badly a handful of
// stops know it: the estimate counts with its redundant dimensions, the paper's nominal level as four more. What is
// stated keeps the whole uncertainty.
NoiseLevels gate_levels(const Preparation& prepared, const Fit& fit, const GroupSums& sums) {
  constexpr double kNominalDimensions = 4.0;
  NoiseLevels levels = fit.noise;
  const NoiseLevels nominal = nominal_levels(fit.noise.law);
  const auto shrink = [&](Group group, double NoiseLevels::*level) {
    const double redundancy = std::max(0.0, sum_of(sums, group).redundancy());
    const double estimated = levels.*level, usual = nominal.*level;
    levels.*level = std::sqrt((redundancy * estimated * estimated + kNominalDimensions * usual * usual) /
                              (redundancy + kNominalDimensions));
  };
  if (!prepared.original.odometry_noise.sigma_xy_m) shrink(Group::kOdometryXy, &NoiseLevels::odometry_xy_m);
  if (!prepared.original.odometry_noise.sigma_yaw_rad) shrink(Group::kOdometryYaw, &NoiseLevels::odometry_yaw_rad);
  return levels;
}

}  // namespace rigproof::ml
