#include "rigproof/calib/estimate/shaking.h"

#include <algorithm>
#include <cmath>

namespace rigproof::ml {
namespace {

constexpr double kOfView = 3.0;  // dimensions
constexpr double kLeastRedundancy = 6.0;

struct Sums {
  double square = 0.0, redundancy = 0.0, corners = 0.0, views = 0.0;
};

// Of the views that others of their stop hold: alone, a camera shakes as its robot does.
std::vector<Sums> sums_of_cameras(const Observations& observations, const std::vector<ViewPull>& pulls) {
  std::vector<int> views_at(observations.stops.size(), 0);
  for (std::size_t v = 0; v < pulls.size(); ++v)
    if (pulls[v].corners > 0) ++views_at[static_cast<std::size_t>(observations.board_views[v].stop)];
  std::vector<Sums> sums(observations.cameras.size());
  for (std::size_t v = 0; v < pulls.size(); ++v) {
    const BoardView& view = observations.board_views[v];
    if (pulls[v].corners == 0 || views_at[static_cast<std::size_t>(view.stop)] < 2) continue;
    Sums& sum = sums[static_cast<std::size_t>(view.camera)];
    sum.square += pulls[v].square;
    sum.redundancy += kOfView - pulls[v].leverage;
    sum.corners += pulls[v].corners;
    ++sum.views;
  }
  return sums;
}

}  // namespace

std::vector<Shaking> shaking_of_cameras(const Problem& problem, const State& state) {
  const Observations& observations = problem.observations();
  std::vector<Shaking> all(observations.cameras.size());
  if (all.size() < 2) return all;
  const std::optional<std::vector<ViewPull>> pulls = problem.view_pulls(state);
  if (!pulls) return all;
  const std::vector<Sums> sums = sums_of_cameras(observations, *pulls);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const Sums& sum = sums[c];
    if (sum.redundancy < kLeastRedundancy) continue;
    const double level_px = problem.noise.corner_scale[c] * stated_corner_px(observations, static_cast<int>(c));
    all[c].redundancy = sum.redundancy;
    all[c].ratio = sum.square / sum.redundancy;
    all[c].displaced_px = level_px * std::sqrt(kOfView * all[c].ratio * sum.views / sum.corners);
  }
  return all;
}

namespace {

// What no polynomial follows of a lens moves a view as a whole, too, where corners tell little of it.
double unexplained_px(const Preparation& prepared, std::size_t camera) {
  constexpr double kTimes = 2.0, kLeast_px = 0.02;
  const std::vector<RemovedErrors::Fine>& fine = prepared.repeating.fine;
  return std::max(kLeast_px, camera < fine.size() ? kTimes * fine[camera].rms_px : 0.0);
}

bool is_shaken(const Shaking& shaking, double unexplained_px) {
  const double by_chance = 1.0 + 5.0 * std::sqrt(2.0 / std::max(1.0, shaking.redundancy));
  return shaking.ratio > by_chance && shaking.displaced_px > unexplained_px;
}

// One of those that are not known to be: as long as it counts with all its corners, it pulls at the others' views, too.
std::optional<std::size_t> most_shaken(const Preparation& prepared, const std::vector<Shaking>& shaking,
                                       const std::vector<bool>& known) {
  std::optional<std::size_t> most;
  for (std::size_t c = 0; c < shaking.size(); ++c)
    if (!known[c] && is_shaken(shaking[c], unexplained_px(prepared, c)) &&
        (!most || shaking[c].displaced_px > shaking[*most].displaced_px))
      most = c;
  return most;
}

}  // namespace

bool shakes_anywhere(const Preparation& prepared, const Fit& fit) {
  const std::vector<Shaking> shaking = shaking_of_cameras(problem_at(prepared, fit, fit.noise), fit.state);
  return most_shaken(prepared, shaking, std::vector<bool>(shaking.size(), false)).has_value();
}

std::optional<Fit> fit_with_shaking(const Preparation& prepared, const Fit& without) {
  constexpr int kRounds = 8;
  constexpr double kSettled = 0.1;  // of the variance
  Fit fit = without;
  Problem problem = problem_at(prepared, without, without.noise);
  EstimatedLevels levels = estimated_levels(prepared.used, prepared.options);
  levels.corners_given.assign(prepared.used.cameras.size(), false);
  fit.shaken_px.assign(prepared.used.cameras.size(), 0.0);
  SolverOptions solver;
  solver.tolerance = prepared.options.tolerance;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Shaking> shaking = shaking_of_cameras(problem, fit.state);
    if (const std::optional<std::size_t> camera = most_shaken(prepared, shaking, levels.corners_given))
      levels.corners_given[*camera] = true;
    double change = 0.0;
    for (std::size_t c = 0; c < shaking.size(); ++c) {
      if (!levels.corners_given[c]) continue;
      fit.shaken_px[c] = shaking[c].displaced_px;
      problem.noise.corner_scale[c] *= std::sqrt(shaking[c].ratio);
      problem.noise.shaken[c] *= std::sqrt(shaking[c].ratio);
      change = std::max(change, std::abs(std::log(shaking[c].ratio)));
    }
    if (change < kSettled) break;
    fit.summary = minimise_with_levels(levels, solver, &problem, &fit.state);
  }
  if (problem.noise.corner_scale == without.noise.corner_scale) return std::nullopt;
  fit.minus_two_log_likelihood = minus_two_log_likelihood(problem, fit.state);
  fit.noise = problem.noise;
  return fit;
}

}  // namespace rigproof::ml
