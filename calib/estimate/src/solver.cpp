#include "rigproof/calib/estimate/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rigproof::ml {
namespace {

constexpr double kMaxDamping = 1e12;

// What is left of a variance component when the data say nothing about it.
constexpr double kMinRedundancy = 0.5;
// Displacements are at their least where few residuals tell otherwise.
constexpr double kMinDisplacementRedundancy = 6.0;
constexpr double kMostOfARound = 2.302585;  // ln 10

// One metre and one radian: nothing beside what determines a camera's pose.
constexpr double kMountingInformation = 1.0;

struct Bounds {
  double low, high;
};
constexpr Bounds kOdometryXy = {kMinOdometryXy_m, 0.5};
constexpr Bounds kOdometryYaw = {kMinOdometryYaw_rad, 0.5};
constexpr Bounds kSuspensionHeight = {kMinSuspensionHeight_m, 0.02};
constexpr Bounds kSuspensionTilt = {kMinSuspensionTilt_rad, 0.02};
constexpr Bounds kScale = {0.05, 200.0};
// The most is .15 rad.
constexpr Bounds kDisplacement = {1.0, 1e4};
// No sensor resolves less, whatever is stated; beyond it, equations that also hold odometry lose that in rounding.
constexpr double kMinCorner_px = 1e-3;
constexpr double kMaxCorner_px = 10.0;    // of sharp corners that contradict all else, two hundred times are no pixel
constexpr double kMinPlane_per_m = 2e-5;  // a hundredth of a millimetre at 0.7 m

// The scale of corners or planes, bounded so that their level does not fall below what no sensor resolves.
Bounds scale_above(double floor, double stated) {
  return {stated > 0.0 ? std::max(kScale.low, floor / stated) : kScale.low, kScale.high};
}

Bounds scale_of_corners(double stated_px) {
  const Bounds bounds = scale_above(kMinCorner_px, stated_px);
  return {bounds.low, stated_px > 0.0 ? std::max(bounds.high, kMaxCorner_px / stated_px) : bounds.high};
}

// Root mean square of the stated sigmas of a camera's planes [1/m].
double stated_plane_per_m(const std::vector<PlaneObservation>& planes, int camera) {
  double variance = 0.0, count = 0.0;
  for (const PlaneObservation& plane : planes) {
    if (plane.camera != camera) continue;
    variance += plane.covariance_per_m2.trace() / 3.0;
    ++count;
  }
  return count > 0.0 ? std::sqrt(variance / count) : 0.0;
}

// ln of what sigma must be multiplied by so that the weighted squares meet their expectation.
// @param loss_dimensions 0 for displacements, which have no loss
double log_change(const GroupSum& all, int loss_dimensions) {
  const GroupSum sum = all.without_outliers();
  const double redundancy = sum.redundancy();
  if (loss_dimensions == 0 && redundancy < kMinDisplacementRedundancy) return -kMostOfARound;
  if (sum.dimensions == 0 || redundancy < kMinRedundancy) return 0.0;
  const double of_loss = loss_dimensions > 0 ? cauchy_moments(loss_dimensions).weighted_square : 1.0;
  const double expected = of_loss * redundancy;
  return 0.5 * std::log(std::max(sum.weighted_square, 1e-300) / expected);
}

// Estimates the levels round by round. Where a level converges slowly, as those that vanish do, the geometric series of
// its changes is summed (Aitken).
class LevelUpdater {
 public:
  LevelUpdater(const EstimatedLevels& levels, Problem* problem) {
    NoiseLevels* noise = &problem->noise;
    const Observations& observations = problem->observations();
    const auto add = [this](bool wanted, Group group, std::size_t camera, int dimensions, Bounds bounds,
                            double* sigma) {
      if (wanted) levels_.push_back({group, static_cast<int>(camera), dimensions, bounds, sigma, 0.0});
    };
    add(levels.odometry_xy, Group::kOdometryXy, 0, 3, kOdometryXy, &noise->odometry_xy_m);
    add(levels.odometry_yaw, Group::kOdometryYaw, 0, 3, kOdometryYaw, &noise->odometry_yaw_rad);
    add(levels.suspension_height, Group::kSuspensionHeight, 0, 3, kSuspensionHeight, &noise->suspension_height_m);
    add(levels.suspension_tilt, Group::kSuspensionTilt, 0, 3, kSuspensionTilt, &noise->suspension_tilt_rad);
    add(levels.displacement, Group::kDisplacement, 0, 0, kDisplacement, &noise->displacement_scale);
    for (std::size_t c = 0; c < noise->corner_scale.size(); ++c) {
      const int camera = static_cast<int>(c);
      const auto plane_scale = [camera](const std::vector<PlaneObservation>& planes) {
        return scale_above(kMinPlane_per_m, stated_plane_per_m(planes, camera));
      };
      const bool given = c < levels.corners_given.size() && levels.corners_given[c];
      add(levels.corners && !given, Group::kCorners, c, 2, scale_of_corners(stated_corner_px(observations, camera)),
          &noise->corner_scale[c]);
      add(levels.planes, Group::kGround, c, 3, plane_scale(observations.ground_planes), &noise->ground_scale[c]);
      // A fixed error over the view is the same in boards at one place: that they scatter less says nothing of it.
      const std::optional<DepthStream>& depth = observations.cameras[c].depth;
      Bounds of_boards = plane_scale(observations.board_planes);
      if (depth && depth->noise.has_bias()) of_boards.low = std::max(of_boards.low, 1.0);
      add(levels.planes, Group::kBoardPlane, c, 3, of_boards, &noise->board_plane_scale[c]);
    }
  }

  /// Largest |ln| by which a level changed.
  double update(const GroupSums& sums) {
    double change = 0.0;
    for (Level& level : levels_) change = std::max(change, level.update(sum_of(sums, level.group, level.camera)));
    return change;
  }

 private:
  struct Level {
    Group group;
    int camera, dimensions;
    Bounds bounds;
    double* sigma;
    double last;  // change of the round before; 0 = none to extrapolate from

    double update(const GroupSum& sum) {
      double step = log_change(sum, dimensions);
      const double ratio = last == 0.0 ? 0.0 : step / last;
      const bool slow = ratio > 0.2 && ratio < 1.0;
      last = slow ? 0.0 : step;  // after an extrapolation two plain rounds
      if (slow) step /= 1.0 - ratio;
      const double before = *sigma;
      *sigma = std::clamp(before * std::exp(std::clamp(step, -kMostOfARound, kMostOfARound)), bounds.low, bounds.high);
      return std::abs(std::log(*sigma / before));
    }
  };
  std::vector<Level> levels_;
};

// Reweighted least squares takes the weights for constant, though they fall as residuals grow: its curvature is too
// large by E[w] / E[psi'], its steps as much too short. (E[psi'] = E[w s] / d, by Stein's lemma.) At wide losses both
// are one.
double lengthening(const Problem& problem, double damping) {
  constexpr double kUndamped = 1e-6;
  if (problem.loss.c2 > CauchyLoss().c2 || damping > kUndamped) return 1.0;
  const LossMoments& moments = cauchy_moments(2);
  return moments.weight / moments.weighted_square;
}

}  // namespace

double stated_corner_px(const Observations& observations, int camera) {
  double variance = 0.0, count = 0.0;
  for (const BoardView& view : observations.board_views) {
    if (view.camera != camera) continue;
    for (const CornerObservation& corner : view.corners) variance += corner.covariance_px2.trace() / 2.0;
    count += static_cast<double>(view.corners.size());
  }
  return count > 0.0 ? std::sqrt(variance / count) : 0.0;
}

SolverSummary minimise(const Problem& problem, const SolverOptions& options, State* state) {
  SolverSummary summary;
  ArrowSystem system = problem.linearise(*state, Weighting::kRobust, &summary.cost, nullptr);
  double damping = 1e-8;
  double indefinite = 0.0;  // damping at which directions that nothing determines made the equations unsolvable
  while (summary.iterations < options.max_iterations && damping < kMaxDamping) {
    ++summary.iterations;
    const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, damping);
    Eigen::VectorXd pose_step, global_step;
    if (!eliminated || !eliminated->step(&pose_step, &global_step)) {
      indefinite = damping;
      damping = std::max(10.0 * damping, 1e-8);
      continue;
    }
    // What the linear model promises, at least: half of the gradient along the step.
    const double promised = -(pose_step.dot(system.pose_gradient) + global_step.dot(system.global_gradient));
    const double longer = lengthening(problem, damping);
    pose_step *= longer;
    global_step *= longer;
    if (promised < options.tolerance) {
      if (damping <= std::max(1e-3, 100.0 * indefinite)) {
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
      // The derivatives of images taken at speed are true to a millionth: no step of theirs brings less than this.
      constexpr double kLeastPromise = 1e-10;
      summary.converged = promised < kLeastPromise * summary.cost;
      if (summary.converged) break;
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
    LevelUpdater updater(levels, problem);
    for (int round = 0; round < kMaxRounds; ++round) {
      total.iterations += minimise(*problem, few, state).iterations;
      const std::optional<GroupSums> sums = problem->sums_with_leverage(*state);
      if (!sums || updater.update(*sums) < kSettled) break;
    }
  }
  SolverSummary last = minimise(*problem, options, state);
  last.iterations += total.iterations;
  return last;
}

namespace {

// Increments alone have factors of the wheels. Their priors are wide, not to bend what is estimated; to count all of
// that width would cost increments seven nats of a drive with right wheels, and favour absolute poses. Returns the
// logarithm of the priors' determinant.
double count_factors_as_usual(const Problem& problem, ArrowSystem* system) {
  constexpr double kUsual = 0.01, kUsualVeer = 0.003;  // assumed, see docs/theory/estimation.md
  double log_determinant = 0.0;
  const auto count = [&](Nuisance nuisance, double most) {
    const Eigen::ArrayXd variance = problem.priors().covariance(nuisance).diagonal().array();
    const Eigen::ArrayXd usual = variance.min(most * most);
    for (Eigen::Index i = 0; problem.layout().has(nuisance) && i < usual.size(); ++i)
      if (usual[i] < variance[i])
        system->global.diagonal()[problem.layout().place(nuisance, 0) + i] += 1.0 / usual[i] - 1.0 / variance[i];
    log_determinant += (usual > 0.0).select(usual, 1.0).log().sum();  // what is believed has no width
  };
  count(Nuisance::kOdometryFactors, kUsual);
  if (problem.priors().has(Nuisance::kOdometryVeer)) count(Nuisance::kOdometryVeer, kUsualVeer);
  return log_determinant;
}

}  // namespace

double minus_two_log_likelihood(const Problem& problem, const State& state) {
  double cost = 0.0;
  ArrowSystem system = problem.linearise(state, Weighting::kInformation, &cost, nullptr);
  // What the drive leaves open of the mountings (their height, where no ground is seen) counts alike in all models.
  system.global.diagonal().head(problem.layout().board()).array() += kMountingInformation;
  system.global.diagonal().tail(6 * static_cast<Eigen::Index>(problem.layout().step().bodies.size())).array() +=
      kMountingInformation;
  double priors = 0.0;
  if (problem.noise.law.model == OdometryModel::kPerIncrement) priors = count_factors_as_usual(problem, &system);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::numeric_limits<double>::infinity();
  const double globals = eliminated->log_determinant_of_globals();
  if (!std::isfinite(globals)) return std::numeric_limits<double>::infinity();
  return cost + problem.log_normalisation() + priors + eliminated->log_determinant_of_poses() + globals;
}

}  // namespace rigproof::ml
