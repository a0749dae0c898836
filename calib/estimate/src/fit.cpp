#include "rigproof/calib/estimate/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Only images of one stop tell their displacements from what the odometry does not tell.
bool shows_displacements(const Observations& observations) {
  constexpr int kLeastMore = 4;  // views, beyond one a stop and one a camera
  int more = -static_cast<int>(observations.cameras.size());
  std::vector<int> views(observations.stops.size(), 0);
  for (const BoardView& view : observations.board_views)
    if (!observations.stops[static_cast<std::size_t>(view.stop)].velocity.isZero(0.0) &&
        ++views[static_cast<std::size_t>(view.stop)] > 1)
      ++more;
  return more >= kLeastMore;
}

NoiseLevels starting_levels(const Observations& observations, const OdometryLaw& law, const MlOptions& options) {
  NoiseLevels levels;
  levels.law = law;
  const OdometryNoise& given = observations.odometry_noise;
  levels.odometry_xy_m = given.sigma_xy_m.value_or(levels.odometry_xy_m);
  levels.odometry_yaw_rad = given.sigma_yaw_rad.value_or(levels.odometry_yaw_rad);
  levels.suspension_height_m = options.suspension_height_sigma_m.value_or(levels.suspension_height_m);
  levels.suspension_tilt_rad = options.suspension_tilt_sigma_rad.value_or(levels.suspension_tilt_rad);
  // From above: a view that is farther off than its corners' noise would pass for noise.
  constexpr double kDisplacementStart = 100.0;
  levels.displacement_scale =
      options.displacement_scale.value_or(shows_displacements(observations) ? kDisplacementStart : 1.0);
  return plausible(levels, observations.cameras.size());
}

// Odometry's own world: absolute poses are compared with it, so the state moves there.
void move_to_odometry_frame(const Observations& observations, State* state) {
  if (observations.stops.empty()) return;
  // The planar rigid motion that best maps the estimated positions and headings to the odometry's.
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero(), mean_to = Eigen::Vector2d::Zero();
  const double n = static_cast<double>(observations.stops.size());
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < observations.stops.size(); ++i) {
    mean_from += Eigen::Vector2d(state->poses[i].x_m, state->poses[i].y_m) / n;
    mean_to += Eigen::Vector2d(observations.stops[i].x_m, observations.stops[i].y_m) / n;
    const double turn = observations.stops[i].yaw_rad - state->poses[i].yaw_rad;
    sine += std::sin(turn);
    cosine += std::cos(turn);
  }
  const double yaw = std::atan2(sine, cosine);
  const Eigen::Vector2d shift = mean_to - Eigen::Rotation2Dd(yaw) * mean_from;
  const Rigid3 T_odom_world = planar_pose(shift.x(), shift.y(), yaw);
  for (RobotPose& pose : state->poses) pose = RobotPose::from_transform(T_odom_world * pose.transform());
  for (Rigid3& T_world_board : state->T_world_board) T_world_board = T_odom_world * T_world_board;
}

// Median of what the residuals of the groups are, in sigmas: how wide the loss must be to see them at the start.
double start_width(const Problem& problem, const State& state) {
  GroupSums sums;
  problem.linearise(state, Weighting::kRobust, nullptr, &sums);
  double widest = 1.0;
  for (const std::vector<GroupSum>& group : sums)
    for (const GroupSum& sum : group)
      if (sum.dimensions > 0) widest = std::max(widest, std::sqrt(sum.square / sum.dimensions));
  return std::min(widest, 1e4);
}

// The loss is narrowed step by step: a start that is off by many sigmas still pulls with all its residuals.
void anneal(Problem* problem, State* state) {
  const double c2 = problem->loss.c2;
  SolverOptions rough;
  rough.max_iterations = 6;
  rough.tolerance = 1e-2;
  for (double width = start_width(*problem, *state); width > 1.5; width = std::sqrt(width)) {
    problem->loss.c2 = c2 * width * width;
    minimise(*problem, rough, state);
  }
  problem->loss.c2 = c2;
}

// The worst view of every stop, if it is wrong: what it had bent of the stop's other views may then straighten.
bool leave_out_wrong_views(Problem* problem, const State& state) {
  constexpr double kWrongView = 0.05;  // mean weight: nearly every corner is tens of sigmas off
  const std::vector<BoardView>& views = problem->observations().board_views;
  std::vector<double> worst(problem->observations().stops.size(), kWrongView);
  std::vector<std::optional<std::size_t>> wrong(worst.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (problem->view_left_out[v]) continue;
    const std::size_t stop = static_cast<std::size_t>(views[v].stop);
    const double weight = problem->view_fit(state, v).mean_weight;
    if (weight >= worst[stop]) continue;
    worst[stop] = weight;
    wrong[stop] = v;
  }
  bool changed = false;
  for (const std::optional<std::size_t>& view : wrong)
    if (view) problem->view_left_out[*view] = changed = true;
  return changed;
}

void fix_unseen_cameras(const Preparation& prepared, Problem* problem) {
  for (int c = 0; c < problem->layout().cameras; ++c)
    problem->camera_fixed[static_cast<std::size_t>(c)] = !prepared.solved(c);
}

// A stop that started from a wrong view may sit where its right views cannot pull it back: every view proposes a
// pose, and the one that most views agree with is taken.
bool reseat_poses(const Preparation& prepared, const Problem& problem, State* state) {
  constexpr double kBetter = 0.25;  // of a view's weight: noise moves less
  bool changed = false;
  std::vector<std::vector<const ViewPose*>> views_at(prepared.used.stops.size());
  for (const ViewPose& view : prepared.views) views_at[static_cast<std::size_t>(view.stop)].push_back(&view);
  for (std::size_t i = 0; i < views_at.size(); ++i) {
    const auto agreement = [&] {
      double sum = 0.0;
      for (const ViewPose* view : views_at[i])
        sum += problem.view_fit(*state, static_cast<std::size_t>(view->view)).mean_weight;
      return sum;
    };
    double best = agreement() + kBetter;
    if (best > static_cast<double>(views_at[i].size()) - 0.5) continue;
    RobotPose kept = state->poses[i];
    for (const ViewPose* view : views_at[i]) {
      const Rigid3& X = state->T_robot_camera[static_cast<std::size_t>(view->camera)];
      const Rigid3& board = state->T_world_board[static_cast<std::size_t>(view->board)];
      state->poses[i] = RobotPose::from_transform(board * view->T_camera_board.inverse() * X.inverse());
      const double weight = agreement();
      if (weight <= best) continue;
      best = weight;
      kept = state->poses[i];
      changed = true;
    }
    state->poses[i] = kept;
  }
  return changed;
}

// Views whose pose could not be found.
void leave_out_without_pose(const Preparation& prepared, Problem* problem) {
  for (const Exclusion& excluded : prepared.excluded)
    for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
      if (prepared.used.board_views[v].stop == excluded.stop &&
          prepared.used.board_views[v].camera == excluded.camera && !excluded.depth && !prepared.has_pose(v))
        problem->view_left_out[v] = true;
}

// Solves from the state of the fit.
void solve(const Preparation& prepared, int leave_out_rounds, Problem* problem, Fit* fit) {
  anneal(problem, &fit->state);
  const EstimatedLevels levels = estimated_levels(prepared.used, prepared.options);
  SolverOptions solver;
  solver.tolerance = prepared.options.tolerance;
  fit->summary = minimise_with_levels(levels, solver, problem, &fit->state);
  if (fit->step.bodies.empty() && reseat_poses(prepared, *problem, &fit->state))
    fit->summary = minimise_with_levels(levels, solver, problem, &fit->state);
  for (int round = 0; round < leave_out_rounds && leave_out_wrong_views(problem, fit->state); ++round)
    fit->summary = minimise_with_levels(levels, solver, problem, &fit->state);
  fit->minus_two_log_likelihood = minus_two_log_likelihood(*problem, fit->state);
  fit->noise = problem->noise;
  fit->view_left_out = problem->view_left_out;
}

}  // namespace

EstimatedLevels estimated_levels(const Observations& observations, const MlOptions& options) {
  EstimatedLevels levels;
  levels.odometry_xy = !observations.odometry_noise.sigma_xy_m;
  levels.odometry_yaw = !observations.odometry_noise.sigma_yaw_rad;
  levels.suspension_height = !options.suspension_height_sigma_m;
  levels.suspension_tilt = !options.suspension_tilt_sigma_rad;
  levels.corners = options.estimate_corner_level;
  levels.planes = options.estimate_plane_level;
  levels.displacement = !options.displacement_scale && shows_displacements(observations);
  return levels;
}

Fit fit_model(const Preparation& prepared, const OdometryLaw& law, int leave_out_rounds, const Fit* other) {
  Fit fit;
  Problem problem(prepared.used, prepared.priors, starting_levels(prepared.used, law, prepared.options),
                  prepared.whitened);
  if (other != nullptr) {
    const NoiseLevels own = problem.noise;
    problem.noise = other->noise;
    problem.noise.law = own.law;
    problem.noise.odometry_xy_m = own.odometry_xy_m;
    problem.noise.odometry_yaw_rad = own.odometry_yaw_rad;
  }
  problem.corners_absorbed = prepared.repeating.absorbed;
  fit.state = other != nullptr ? other->state : prepared.start;
  fix_unseen_cameras(prepared, &problem);
  leave_out_without_pose(prepared, &problem);
  if (law.model == OdometryModel::kPerPose) move_to_odometry_frame(prepared.used, &fit.state);
  solve(prepared, leave_out_rounds, &problem, &fit);
  return fit;
}

namespace {

// Of the poses of a body that the views after a step propose, the one that is nearest to all others: a start that is
// right though the body fell over.
Rigid3 pose_after(const Preparation& prepared, const State& state, const Step& step, int body) {
  std::vector<Rigid3> proposed;
  for (const ViewPose& view : prepared.views) {
    if (view.stop < step.split || body != (Step::is_board(body) ? Step::board(view.board) : view.camera)) continue;
    const Rigid3 robot = state.poses[static_cast<std::size_t>(view.stop)].transform();
    proposed.push_back(Step::is_board(body)
                           ? robot * state.T_robot_camera[static_cast<std::size_t>(view.camera)] * view.T_camera_board
                           : robot.inverse() * state.first_pose(Step::board(view.board)) *
                                 view.T_camera_board.inverse());
  }
  constexpr std::size_t kEnough = 50;
  if (proposed.size() > kEnough) proposed.resize(kEnough);
  double least = std::numeric_limits<double>::infinity();
  Rigid3 nearest = state.first_pose(body);
  for (const Rigid3& one : proposed) {
    double sum = 0.0;
    for (const Rigid3& other : proposed) {
      const Vector6d apart = transform_error(one, other);
      sum += std::min(1.0, apart.head<3>().norm() + apart.tail<3>().norm());
    }
    if (sum >= least) continue;
    least = sum;
    nearest = one;
  }
  return nearest;
}

}  // namespace

Fit fit_with_step(const Preparation& prepared, const Fit& without, const Step& step) {
  Fit fit;
  fit.step = step;
  fit.state = without.state;
  fit.state.second_poses.clear();
  for (const int body : step.bodies) fit.state.second_poses.push_back(pose_after(prepared, without.state, step, body));
  Problem problem(prepared.used, prepared.priors, without.noise, prepared.whitened);
  problem.add(step);
  problem.corners_absorbed = prepared.repeating.absorbed;
  fix_unseen_cameras(prepared, &problem);
  leave_out_without_pose(prepared, &problem);
  solve(prepared, kLeaveOutRounds, &problem, &fit);
  return fit;
}

Fit fit_again(const Preparation& prepared, const Fit& before) {
  Fit fit = before;
  Problem problem = problem_at(prepared, before, before.noise);
  EstimatedLevels levels = estimated_levels(prepared.used, prepared.options);
  for (const double shaken_px : before.shaken_px) levels.corners_given.push_back(shaken_px > 0.0);
  SolverOptions solver;
  solver.tolerance = prepared.options.tolerance;
  fit.summary = minimise_with_levels(levels, solver, &problem, &fit.state);
  fit.minus_two_log_likelihood = minus_two_log_likelihood(problem, fit.state);
  fit.noise = problem.noise;
  return fit;
}

Problem problem_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels, const Priors& priors) {
  Problem problem(prepared.used, priors, levels, prepared.whitened);
  if (!fit.step.bodies.empty()) problem.add(fit.step);
  if (!fit.view_left_out.empty()) problem.view_left_out = fit.view_left_out;
  problem.corners_absorbed = prepared.repeating.absorbed;
  fix_unseen_cameras(prepared, &problem);
  return problem;
}

Problem problem_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels) {
  return problem_at(prepared, fit, levels, prepared.priors);
}

}  // namespace rigproof::ml
