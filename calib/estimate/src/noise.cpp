#include "rigproof/calib/estimate/noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Density of the chi distribution (the residual's length r) of d dimensions, without its constant.
double chi_density(int dimensions, double r) { return std::pow(r, dimensions - 1) * std::exp(-0.5 * r * r); }

LossMoments integrate(int dimensions) {
  const CauchyLoss loss;
  LossMoments sums{0.0, 0.0, 0.0};
  double mass = 0.0, slope = 0.0, square = 0.0;
  constexpr int kSteps = 4000;  // the integrand is smooth: the sum is exact to 1e-10
  constexpr double kEnd = 10.0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = (i + 0.5) * kEnd / kSteps, s = r * r;
    const double p = chi_density(dimensions, r), w = loss.weight(s);
    mass += p;
    sums.weight += p * w;
    sums.weighted_square += p * w * s / dimensions;
    slope += p * (w - 2.0 * s * w * w / (loss.c2 * dimensions));
    square += p * w * w * s / dimensions;
  }
  sums.weight /= mass;
  sums.weighted_square /= mass;
  sums.efficiency = (slope / mass) * (slope / mass) / (square / mass);
  return sums;
}

}  // namespace

NoiseLevels plausible(NoiseLevels levels, std::size_t cameras) {
  levels.odometry_xy_m = std::max(levels.odometry_xy_m, kMinOdometryXy_m);
  levels.odometry_yaw_rad = std::max(levels.odometry_yaw_rad, kMinOdometryYaw_rad);
  levels.suspension_height_m = std::max(levels.suspension_height_m, kMinSuspensionHeight_m);
  levels.suspension_tilt_rad = std::max(levels.suspension_tilt_rad, kMinSuspensionTilt_rad);
  for (std::vector<double>* scales :
       {&levels.corner_scale, &levels.shaken, &levels.ground_scale, &levels.board_plane_scale})
    scales->assign(cameras, 1.0);
  return levels;
}

double CauchyLoss::cost(double s) const { return c2 * std::log1p(s / c2); }

const LossMoments& cauchy_moments(int dimensions) {
  static const std::array<LossMoments, 3> kMoments = {integrate(1), integrate(2), integrate(3)};
  return kMoments.at(static_cast<std::size_t>(dimensions - 1));
}

}  // namespace rigproof::ml
