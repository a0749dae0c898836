#include "yaw_drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "bending.h"
#include "faults.h"
#include "rigproof/calib/estimate/residuals.h"
#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

constexpr std::size_t kLeastStops = 6;

// A turn between two stops, by the odometry less by the cameras, with its variance for a level of one.
struct Turn {
  double off_rad, turn_rad, lasts_s, variance;
};

std::vector<Turn> turns_of(const Observations& observations, const NoiseLevels& noise, const State& state) {
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < observations.stops.size(); ++i) {
    const Stop &from = observations.stops[i - 1], &to = observations.stops[i];
    const double told = measured_increment(from, to).z();
    const double turn = told + wrap_angle(state.poses[i].yaw_rad - state.poses[i - 1].yaw_rad - told);
    const OdometryWay way(from, to, observations.odometry_noise.rotation_centre_m);
    const double variance = noise.law.along_way ? way.noise_of_heading(noise.law)(2, 2) : 1.0;
    const double veer = state.odometry_veer() * way.motion(1.0).by_veer.z();
    if (variance > 0.0)
      turns.push_back({told - state.odometry_yaw_factor() * turn + veer, turn, to.stamp_s - from.stamp_s, variance});
  }
  return turns;
}

Fit without_drift(const Preparation& prepared, const Fit& fit) {
  return fit_model(prepared, fit.noise.law, kLeaveOutRounds);
}

}  // namespace

double YawDrift::deviations() const {
  if (!(sigma_rad_s > 0.0)) return 0.0;
  const double t = rad_s / sigma_rad_s, n = redundancy;
  return (8.0 * n + 1.0) / (8.0 * n + 3.0) * std::sqrt(n * std::log1p(t * t / n));
}

YawDrift estimate_yaw_drift(const Observations& observations, const NoiseLevels& noise, const State& state) {
  if (observations.stops.size() < kLeastStops || state.poses.size() != observations.stops.size()) return {};
  // Of absolute odometry the errors of two motions in a row are opposite, and tell nothing of a drift.
  if (noise.law.model != OdometryModel::kPerIncrement) return {};
  const CauchyLoss loss;
  const double level = noise.odometry_yaw_rad * noise.odometry_yaw_rad;
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  double squares = 0.0, weights = 0.0;
  for (const Turn& turn : turns_of(observations, noise, state)) {
    const double variance = level * turn.variance, square = turn.off_rad * turn.off_rad / variance;
    const double weight = loss.weight(square);
    const Eigen::Vector2d by(turn.turn_rad, turn.lasts_s);
    H += weight / variance * by * by.transpose();
    g += weight / variance * turn.off_rad * by;
    squares += weight * square;
    weights += weight;
  }
  const Eigen::LDLT<Eigen::Matrix2d> ldlt(H);
  const Eigen::Vector2d slope = ldlt.solve(g);
  const double variance = ldlt.solve(Eigen::Vector2d::UnitY().eval()).y();
  // By the scatter that is left of the residuals: a solution that is bent has levels that are too wide.
  const double redundancy = std::max(1.0, weights - 2.0), left = (squares - g.dot(slope)) / redundancy;
  if (!slope.allFinite() || !(variance > 0.0) || !(left > 0.0)) return {};
  return {slope.y(), std::sqrt(variance * left), redundancy};
}

std::optional<FoundDrift> find_yaw_drift(const Preparation& prepared, const Fit& fit) {
  // A healthy drive is solved again once in 400 times, and blamed not once in a million.
  constexpr double kWorthASolution = 3.0, kSure = 5.0, kGain = 20.0;
  constexpr int kSteps = 3;
  YawDrift drift = estimate_yaw_drift(prepared.used, fit.noise, fit.state);
  if (drift.deviations() < kWorthASolution) return std::nullopt;
  for (int step = 0; step < kSteps; ++step) {
    const Fault fault = odometry_drifting(prepared.original, drift.rad_s);
    const Observations repaired = undone(fault, prepared.original);
    const Preparation straight = prepare(repaired, prepared.options, &prepared.views);
    if (!straight.solvable()) return std::nullopt;
    const Fit with = without_drift(straight, fit);
    const YawDrift rest = estimate_yaw_drift(repaired, with.noise, with.state);
    if (rest.deviations() > 0.1 && step + 1 < kSteps) {
      drift = {drift.rad_s + rest.rad_s, rest.sigma_rad_s, rest.redundancy};
      continue;
    }
    const std::optional<GlobalCovariance> covariance = stated_covariance(straight, with);
    if (!covariance || drift.deviations() < kSure ||
        with.minus_two_log_likelihood > fit.minus_two_log_likelihood - kGain)
      return std::nullopt;
    const bool bends = bent_by(fit.state, straight, with, *covariance) > kBentSigmas;
    const Finding cause = bends ? fault.cause : Finding("odometry.yaw_drifts_slightly", fault.cause.values);
    return FoundDrift{cause.with({{"deviations", drift.deviations()}}), bends};
  }
  return std::nullopt;
}

}  // namespace rigproof::ml
