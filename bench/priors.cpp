// Whether the stated uncertainty, and each line of its budget, is what errors drawn from the priors come to: the tables
// of docs/measurements/priors.md. No pictures are made.
//   bench_priors [--robots 1000] [--wrong-priors 100] [--redrawn 12] [--draws 40] [--stops 20] [--jobs N]
// First robots whose errors are all drawn, calibrated with the priors that they are drawn from, and some of them with
// priors half and twice as wide. Then `redrawn` robots of which one source after the other is drawn `draws` times and
// the others held: the variance of the answers over what its line of the budget states. Exit code 1 where the pooled
// NEES with true priors lies outside its 99 % interval.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "bench_main.h"
#include "nees_pool.h"
#include "priors_robots.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/vision/parallel.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/validate/validate.h"

namespace {

using namespace rigproof;

struct Options {
  int robots = 1000, wrong_priors = 100, redrawn = 12, draws = 40, stops = 20, jobs = 0;
};

bench::Seeds all_of(std::uint64_t seed) {
  bench::Seeds seeds;
  seeds.fill(seed);
  return seeds;
}

MlOptions widened(double factor) {
  MlOptions options;
  PriorSigmas& priors = options.priors;
  for (double* sigma : {&priors.odometry_scale, &priors.odometry_yaw_factor, &priors.odometry_veer_rad_per_m})
    *sigma *= factor;
  return options;
}

// ------------------------------------------------------------------------------------------------- all drawn at once

struct Answered {
  Comparison comparison;
  int suspicions = 0;
};

Answered answered(int robot, double factor, int stops) {
  const auto seed = static_cast<std::uint64_t>(robot);
  bench::DrawnRobot drawn = bench::draw_robot(seed, all_of(seed), stops);
  bench::widen_priors(factor, &drawn.observations);
  const Result result = estimate_maximum_likelihood(drawn.observations, widened(factor)).result;
  const auto is_suspicion = [](const Finding& note) { return note.severity == Severity::kSuspect; };
  return {compare(result, drawn.truth),
          static_cast<int>(std::count_if(result.notes.begin(), result.notes.end(), is_suspicion))};
}

struct Tally {
  std::map<std::string, int> statuses;
  bench::NeesPool pool;
  std::array<double, 6> z_squares{};
  int cameras = 0, suspected = 0, beyond = 0;
};

void add(const Answered& one, Tally* tally) {
  const Comparison& comparison = one.comparison;
  ++tally->statuses[result_status_name(comparison.status)];
  tally->suspected += one.suspicions > 0;
  if (comparison.nees) tally->pool.add(*comparison.nees, comparison.nees_degrees_of_freedom);
  double largest = 0.0;
  for (const TransformError& error : comparison.camera_to_robot)
    for (int axis = 0; axis < 6; ++axis) largest = std::max(largest, std::abs(error.z(axis).value_or(0.0)));
  tally->beyond += largest > 5.0 && one.suspicions == 0;
  if (comparison.status != ResultStatus::kSolved) return;
  for (const TransformError& error : comparison.camera_to_robot) {
    ++tally->cameras;
    for (int axis = 0; axis < 6; ++axis)
      tally->z_squares[static_cast<std::size_t>(axis)] += std::pow(error.z(axis).value_or(0.0), 2);
  }
}

bool print_robots(const Options& options, int robots, double factor) {
  std::vector<Answered> answers(static_cast<std::size_t>(robots));
  detection::for_each_parallel(answers.size(), options.jobs, [&](std::size_t i) {
    answers[i] = answered(static_cast<int>(i), factor, options.stops);
  });
  Tally tally;
  for (const Answered& one : answers) add(one, &tally);
  std::printf("priors %.1f times as wide as the truth:", factor);
  for (const auto& [status, count] : tally.statuses) std::printf(" %d %s,", count, status.c_str());
  std::printf(" %d suspected, %d beyond five sigmas without a word\n", tally.suspected, tally.beyond);
  const bool holds = bench::print_pool("  all", tally.pool);
  std::printf("  rms error over sigma, camera to robot:");
  for (int axis = 0; axis < 6; ++axis)
    std::printf("  %s %.2f", kDegreeOfFreedomNames[static_cast<std::size_t>(axis)],
                std::sqrt(tally.z_squares[static_cast<std::size_t>(axis)] / std::max(1, tally.cameras)));
  std::printf("\n");
  std::fflush(stdout);
  return holds;
}

// ---------------------------------------------------------------------------------------------- one source redrawn

/// Of one degree of freedom of one robot, over its draws.
struct Scatter {
  int count = 0;
  double mean = 0.0, squares = 0.0;  // Welford's
  double stated = 0.0, share = 0.0;  // sums

  void add(double error, double stated_variance, double line_share) {
    const double before = error - mean;
    mean += before / ++count;
    squares += before * (error - mean);
    stated += stated_variance;
    share += line_share;
  }
  double ratio() const { return squares / (count - 1) / (stated / count); }
};

const EstimatedTransform::Share* line_of(const EstimatedTransform& transform, const std::string& source) {
  const auto found = std::find_if(transform.budget.begin(), transform.budget.end(),
                                  [&source](const auto& line) { return line.source == source; });
  return found == transform.budget.end() ? nullptr : &*found;
}

// Absolute errors: what the others make of them is the same in all draws, but for a little.
std::vector<Scatter> redrawn(const Options& options, int robot, std::size_t source) {
  const auto base = static_cast<std::uint64_t>(robot);
  std::vector<Scatter> scatters;
  for (int draw = 0; draw < options.draws; ++draw) {
    bench::Seeds seeds = all_of(base);
    seeds[source] = 1000000 + static_cast<std::uint64_t>(options.draws) * base + static_cast<std::uint64_t>(draw);
    const bench::DrawnRobot drawn = bench::draw_robot(base, seeds, options.stops);
    const Result result = estimate_maximum_likelihood(drawn.observations).result;
    if (result.status != ResultStatus::kSolved) continue;
    scatters.resize(6 * result.camera_to_robot.size());
    for (std::size_t c = 0; c < result.camera_to_robot.size(); ++c) {
      const EstimatedTransform& transform = result.camera_to_robot[c];
      const EstimatedTransform::Share* line = line_of(transform, bench::kSources[source]);
      if (line == nullptr || !transform.covariance) continue;
      const Vector6d error = transform_error(transform.T_parent_child, drawn.truth.cameras[c].T_robot_camera);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        scatters[6 * c + axis].add(error[i], line->share[axis] * (*transform.covariance)(i, i), line->share[axis]);
      }
    }
  }
  return scatters;
}

// Lines that hold hardly any of a variance are left out.
void print_source(const Options& options, std::size_t source) {
  constexpr double kWorthLooking = 0.02;
  std::vector<std::vector<Scatter>> robots(static_cast<std::size_t>(options.redrawn));
  detection::for_each_parallel(robots.size(), options.jobs,
                               [&](std::size_t i) { robots[i] = redrawn(options, static_cast<int>(i), source); });
  std::array<Scatter, 6> axes;
  Scatter all;  // over the means of robots
  for (const std::vector<Scatter>& robot : robots) {
    Scatter mean;
    for (std::size_t i = 0; i < robot.size(); ++i) {
      if (robot[i].count < 3 || robot[i].share < kWorthLooking * robot[i].count) continue;
      axes[i % 6].add(robot[i].ratio(), 0.0, robot[i].share / robot[i].count);
      mean.add(robot[i].ratio(), 0.0, 0.0);
    }
    if (mean.count > 0) all.add(mean.mean, 0.0, 0.0);
  }
  std::printf("%-24s", bench::kSources[source]);
  if (all.count < 2) {
    std::printf(" hardly any\n");
    return;
  }
  std::printf(" %.2f +- %.2f ", all.mean, std::sqrt(all.squares / (all.count - 1) / all.count));
  for (const Scatter& axis : axes) {
    if (axis.count == 0)
      std::printf("  %12s", "-");
    else
      std::printf("  %4.2f (%3.0f %%)", axis.mean, 100.0 * axis.share / axis.count);
  }
  std::printf("\n");
  std::fflush(stdout);
}

int measure(const Options& options) {
  bool holds = true;
  if (options.robots > 0) {
    holds = print_robots(options, options.robots, 1.0);
    for (const double factor : {0.5, 2.0}) print_robots(options, options.wrong_priors, factor);
  }
  if (options.redrawn > 1) {
    std::printf("variance over that of the budget's line, mean of robots; of each axis (the line's share)\n%-38s", "");
    for (const char* name : kDegreeOfFreedomNames) std::printf("  %12s", name);
    std::printf("\n");
    for (std::size_t source = 0; source < bench::kSources.size(); ++source) print_source(options, source);
  }
  return static_cast<int>(holds ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  const auto declare = [&](CLI::App& app) {
    add_count(app, "--robots", options.robots);
    add_count(app, "--wrong-priors", options.wrong_priors);
    add_count(app, "--redrawn", options.redrawn);
    app.add_option("--draws", options.draws)->check(CLI::Range(3, 100000));
    app.add_option("--stops", options.stops)->check(CLI::Range(3, 1000));
    add_count(app, "--jobs", options.jobs);
  };
  return bench_main(count, arguments, "Errors drawn from the priors against the stated uncertainty and its budget",
                    declare, [&] { return measure(options); });
}
