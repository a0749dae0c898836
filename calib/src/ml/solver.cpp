#include "ml/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigproof::ml {
namespace {

constexpr double kMaxDamping = 1e12;

// What is left of a variance component when the data say nothing about it.
constexpr double kMinRedundancy = 0.5;

struct Bounds {
  double low, high;
};
constexpr Bounds kOdometryXy = {kMinOdometryXy_m, 0.5};
constexpr Bounds kOdometryYaw = {kMinOdometryYaw_rad, 0.5};
constexpr Bounds kSuspensionHeight = {kMinSuspensionHeight_m, 0.02};
constexpr Bounds kSuspensionTilt = {kMinSuspensionTilt_rad, 0.02};
constexpr Bounds kScale = {0.05, 200.0};

// Multiplies sigma so that the weighted squares meet their expectation; returns |log| of the change.
double update(const GroupSum& all, int loss_dimensions, const Bounds& bounds, double* sigma) {
  const GroupSum sum = all.without_outliers();
  const double redundancy = sum.redundancy();
  if (sum.dimensions == 0 || redundancy < kMinRedundancy) return 0.0;
  const double expected = cauchy_moments(loss_dimensions).weighted_square * redundancy;
  // One step changes a level by at most a factor of ten.
  const double factor = std::clamp(std::sqrt(sum.weighted_square / expected), 0.1, 10.0);
  const double before = *sigma;
  *sigma = std::clamp(before * factor, bounds.low, bounds.high);
  return std::abs(std::log(*sigma / before));
}

double update_levels(const EstimatedLevels& levels, const GroupSums& sums, NoiseLevels* noise) {
  double change = 0.0;
  const auto take = [&change](double c) { change = std::max(change, c); };
  if (levels.odometry_xy) take(update(sum_of(sums, Group::kOdometryXy), 3, kOdometryXy, &noise->odometry_xy_m));
  if (levels.odometry_yaw) take(update(sum_of(sums, Group::kOdometryYaw), 3, kOdometryYaw, &noise->odometry_yaw_rad));
  if (levels.suspension_height)
    take(update(sum_of(sums, Group::kSuspensionHeight), 3, kSuspensionHeight, &noise->suspension_height_m));
  if (levels.suspension_tilt)
    take(update(sum_of(sums, Group::kSuspensionTilt), 3, kSuspensionTilt, &noise->suspension_tilt_rad));
  for (std::size_t c = 0; c < noise->corner_scale.size(); ++c) {
    const int camera = static_cast<int>(c);
    if (levels.corners) take(update(sum_of(sums, Group::kCorners, camera), 2, kScale, &noise->corner_scale[c]));
    if (!levels.planes) continue;
    take(update(sum_of(sums, Group::kGround, camera), 3, kScale, &noise->ground_scale[c]));
    take(update(sum_of(sums, Group::kBoardPlane, camera), 3, kScale, &noise->board_plane_scale[c]));
  }
  return change;
}

}  // namespace

SolverSummary minimise(const Problem& problem, const SolverOptions& options, State* state) {
  SolverSummary summary;
  ArrowSystem system = problem.linearise(*state, Weighting::kRobust, &summary.cost, nullptr);
  double damping = 1e-8;
  while (summary.iterations < options.max_iterations && damping < kMaxDamping) {
    ++summary.iterations;
    const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, damping);
    Eigen::VectorXd pose_step, global_step;
    if (!eliminated || !eliminated->step(&pose_step, &global_step)) {
      damping = std::max(10.0 * damping, 1e-8);
      continue;
    }
    // What the linear model promises, at least: half of the gradient along the step.
    const double promised = -(pose_step.dot(system.pose_gradient) + global_step.dot(system.global_gradient));
    if (promised < options.tolerance) {
      if (damping <= 1e-3) {
        *state = moved(*state, problem.layout(), pose_step, global_step);
        summary.converged = true;
        break;
      }
      damping *= 1e-2;  // a short step only because it was damped
      continue;
    }
    const State trial = moved(*state, problem.layout(), pose_step, global_step);
    double trial_cost = 0.0;
    ArrowSystem trial_system = problem.linearise(trial, Weighting::kRobust, &trial_cost, nullptr);
    // Rounding: near the optimum of a large cost the last digits decide nothing.
    if (!(trial_cost <= summary.cost + 1e-13 * summary.cost)) {
      damping = std::max(10.0 * damping, 1e-6);
      continue;
    }
    *state = trial;
    system = std::move(trial_system);
    summary.cost = trial_cost;
    damping = std::max(0.1 * damping, 1e-12);
  }
  return summary;
}

SolverSummary minimise_with_levels(const EstimatedLevels& levels, const SolverOptions& options, Problem* problem,
                                   State* state) {
  constexpr int kMaxRounds = 40;
  constexpr double kSettled = 0.003;  // relative change of a sigma: far below its own uncertainty
  SolverSummary total;
  if (levels.any()) {
    SolverOptions few = options;
    few.max_iterations = 4;
    few.tolerance = std::max(options.tolerance, 1e-3);
    for (int round = 0; round < kMaxRounds; ++round) {
      total.iterations += minimise(*problem, few, state).iterations;
      const std::optional<GroupSums> sums = problem->sums_with_leverage(*state);
      if (!sums || update_levels(levels, *sums, &problem->noise) < kSettled) break;
    }
  }
  SolverSummary last = minimise(*problem, options, state);
  last.iterations += total.iterations;
  return last;
}

double minus_two_log_likelihood(const Problem& problem, const State& state) {
  double cost = 0.0;
  const ArrowSystem system = problem.linearise(state, Weighting::kInformation, &cost, nullptr);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::numeric_limits<double>::infinity();
  const double priors =
      problem.noise.odometry_model == OdometryModel::kPerIncrement
          ? 2.0 * (std::log(problem.priors().odometry_scale) + std::log(problem.priors().odometry_yaw_factor))
          : 0.0;
  const double globals = eliminated->log_determinant_of_globals();
  return cost + problem.log_normalisation() + priors + eliminated->log_determinant_of_poses() + globals;
}

}  // namespace rigproof::ml
