// How often `moved` raises a false alarm, and how often it finds shifts of a given size: the tables of
// docs/measurements/moved.md.
//   bench_moved [trials, default 2000] [alarms | detections] [--strangers] [--verbose]
// The reference rig in geometric mode (0.1 px, odometry lambda 1), previous calibrations of 20 stops. With --strangers
// each robot's lenses, board and depth differ from what is stated by errors drawn from the usual priors.
#include "rigproof/calib/plan/moved.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench_main.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/geometric/geometric.h"
#include "stranger.h"

namespace rigproof {
namespace {

constexpr int kPrevious = 400;  // calibrations that trials take by turns

// A robot, and what its first drive told.
struct Calibrated {
  std::optional<Stranger> robot;  // absent: the reference rig, exactly as stated
  Result result;
};

Observations observed(const std::optional<Stranger>& robot, std::uint64_t seed, int stops,
                      const Vector6d& shift = Vector6d::Zero()) {
  GeometricConfig config = robot ? robot->config : GeometricConfig();
  config.seed = seed;
  config.stops = stops;
  config.rig.T_robot_camera[1] = apply_transform_error(config.rig.T_robot_camera[1], shift);
  if (!robot) return draw_geometric_run(config).observations;
  Stranger shifted = *robot;
  shifted.config = config;
  return drive(shifted, seed, stops).observations;
}

std::vector<Calibrated> calibrated_robots(bool strangers) {
  std::vector<Calibrated> robots;
  for (int i = 0; i < kPrevious; ++i) {
    Calibrated made;
    if (strangers) made.robot = draw_stranger(i);
    made.result = default_method().solve(observed(made.robot, 100000 + static_cast<std::uint64_t>(i), 20));
    robots.push_back(std::move(made));
  }
  return robots;
}

MovedReport trial(const Calibrated& before, std::uint64_t seed, int stops, const Vector6d& shift) {
  MovedOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  return detect_movement(before.result, observed(before.robot, seed, stops, shift), options);
}

// Half the width of a 95 % confidence interval of a share.
double half_width(int count, int trials) {
  const double share = static_cast<double>(count) / trials;
  return 1.96 * std::sqrt(std::max(share * (1.0 - share), 1.0 / trials) / trials);
}

void tell(int stops, std::uint64_t seed, const MovedReport& report) {
  std::printf("  %d stops, seed %llu: p %.2g, chi-square %.1f of %d", stops, static_cast<unsigned long long>(seed),
              report.p_value, report.statistic, report.degrees_of_freedom);
  for (const auto* findings : {&report.reasons, &report.notes})
    for (const Finding& finding : *findings) {
      std::printf(" %s", finding.code.c_str());
      for (const Finding& because : finding.because) std::printf(" (%s)", because.code.c_str());
    }
  std::printf("\n");
}

// Nothing in these drives contradicts anything.
bool blames_the_data(const MovedReport& report) {
  return report.degrees_of_freedom == 0 || has_code(report.notes, "moved.odometry_ignored");
}

void false_alarms(const std::vector<Calibrated>& previous, int trials, bool verbose) {
  const std::vector<double> levels = {0.05, 0.01, 0.001};
  std::printf("false alarms of %d trials, 95 %% confidence\nstops", trials);
  for (const double level : levels) std::printf("  %16.1f %%", 100.0 * level);
  std::printf("  chi-square / dof  data blamed\n");
  for (const int stops : {1, 2, 3, 5}) {
    std::vector<int> alarms(levels.size(), 0);
    double ratio = 0.0;
    int blamed = 0;
    for (int i = 0; i < trials; ++i) {
      const std::uint64_t seed = 1000000 + 10 * static_cast<std::uint64_t>(i) + static_cast<std::uint64_t>(stops);
      const MovedReport report =
          trial(previous[static_cast<std::size_t>(i % kPrevious)], seed, stops, Vector6d::Zero());
      for (std::size_t k = 0; k < levels.size(); ++k) alarms[k] += report.p_value < levels[k] ? 1 : 0;
      ratio += report.statistic / std::max(1, report.degrees_of_freedom) / trials;
      blamed += blames_the_data(report) ? 1 : 0;
      if (verbose && (report.p_value < levels[1] || blames_the_data(report))) tell(stops, seed, report);
    }
    std::printf("%5d", stops);
    for (const int count : alarms)
      std::printf("  %7.2f +- %5.2f %%", 100.0 * count / trials, 100.0 * half_width(count, trials));
    std::printf("  %16.3f  %11d\n", ratio, blamed);
    std::fflush(stdout);
  }
}

void detections(const std::vector<Calibrated>& previous, int trials) {
  std::printf("detected at 0.1 %% / center named alone, of %d trials [%%]\n", trials);
  std::printf("%-10s %6s", "shift", "size");
  for (const int stops : {1, 2, 5}) std::printf("  %9d stop", stops);
  std::printf("\n");
  for (const int axis : {0, 1, 2, 3, 5}) {
    const bool length = axis < 3;
    for (const double size : {0.25, 0.5, 1.0, 2.0, 4.0, 16.0}) {  // times 2 mm, or .02 deg
      std::printf("%-10s %6.3f", kDegreeOfFreedomNames[static_cast<std::size_t>(axis)],
                  length ? 2.0 * size : 0.02 * size);
      for (const int stops : {1, 2, 5}) {
        int found = 0, named = 0;
        const double shift = length ? 0.002 * size : deg_to_rad(0.02 * size);
        for (int i = 0; i < trials; ++i) {
          const MovedReport report =
              trial(previous[static_cast<std::size_t>(i % kPrevious)], 5000000 + static_cast<std::uint64_t>(i), stops,
                    shift * Vector6d::Unit(axis));
          found += report.outcome == MovedOutcome::kMoved ? 1 : 0;
          named += report.cameras[1].verdict == MovedVerdict::kMoved && !report.rig_moved &&
                           report.cameras[0].verdict != MovedVerdict::kMoved &&
                           report.cameras[2].verdict != MovedVerdict::kMoved
                       ? 1
                       : 0;
        }
        std::printf("   %4.0f / %4.0f", 100.0 * found / trials, 100.0 * named / trials);
      }
      std::printf(length ? "   mm\n" : "   deg\n");
    }
  }
}

}  // namespace
}  // namespace rigproof

int main(int count, char** arguments) {
  int trials = 2000;
  std::string only;
  bool verbose = false, strangers = false;
  const auto declare = [&](CLI::App& app) {
    app.add_option("trials", trials)->check(CLI::Range(1, 1000000));
    app.add_option("only", only)->check(CLI::IsMember({"alarms", "detections"}));
    app.add_flag("--strangers", strangers);
    app.add_flag("--verbose", verbose);
  };
  return rigproof::bench_main(count, arguments, "False alarms of `moved`, and shifts that it finds", declare, [&] {
    const std::vector<rigproof::Calibrated> previous = rigproof::calibrated_robots(strangers);
    if (only != "detections") rigproof::false_alarms(previous, trials, verbose);
    if (only != "alarms") rigproof::detections(previous, std::max(1, trials / 20));
    return 0;
  });
}
