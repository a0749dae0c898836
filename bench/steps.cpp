// Cameras, or the board, that were moved during the drive: the largest score of a step in healthy drives, false alarms,
// and how often steps of a given size are found. Geometric mode: the reference rig and random ones, 7 to 60 stops,
// noise declared or not, lenses and board as stated or off by what their priors say.
//   bench_steps [healthy drives, default 1000] [trials of each size, default 40] [--verbose]
#include "steps.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench_main.h"
#include "moved_during.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// Nothing is stated of lenses, board and depth: their usual priors hold.
void forget_what_is_told(Observations* observations) {
  observations->board.doubt();
  for (RigCamera& camera : observations->cameras) camera.intrinsics_sigma = IntrinsicsSigma();
}

GeometricConfig drive(int i) {
  const int stops[] = {7, 10, 20, 40, 60};
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(i);
  if (i % 4 >= 2) config.rig = random_rig(config.seed, 1 + i / 4 % 4);
  config.stops = stops[i % 5];
  config.lambda = i % 3 == 0 ? 0.2 : 1.0;
  config.board_planes = i % 7 < 3;
  config.along_way = i % 6 == 1;
  config.odometry_model = i % 6 == 5 ? OdometryModel::kPerPose : OdometryModel::kPerIncrement;
  config.declare_odometry_model = config.declare_odometry_sigmas = i % 2 == 0 && !config.along_way;
  config.suspension_height_sigma_m = i % 8 == 3 ? 5e-4 : 0.0;
  config.suspension_tilt_sigma_rad = i % 8 == 3 ? 1e-3 : 0.0;
  return config;
}

bool says_moved(const std::vector<Finding>& findings) {
  for (const char* code : {"camera.moved", "camera.moved_slightly", "board.moved", "board.moved_slightly"})
    if (has_code(findings, code)) return true;
  return false;
}

bool says_moved(const Result& result) { return says_moved(result.reasons) || says_moved(result.notes); }

struct Largest {
  double score = 0.0, confirmed = 0.0;
};

Largest largest_of(const Observations& observations) {
  const MlOptions options;
  const ml::Preparation prepared = ml::prepare(observations, options);
  if (!prepared.solvable()) return {};
  const ml::Fit fit = ml::choose_odometry(prepared).fit;
  std::vector<ml::StepScore> scores;
  const int stops = static_cast<int>(observations.stops.size());
  ml::problem_at(prepared, fit, fit.noise)
      .sums_with_leverage(fit.state, ml::splits_of(stops, ml::kSplitsAtFirst), &scores);
  Largest largest;
  for (const ml::StepScore& score : scores) largest.score = std::max(largest.score, score.square);
  if (const auto found = ml::find_step(prepared, fit, scores))
    largest.confirmed = found->deviations * found->deviations;
  return largest;
}

void healthy(int drives, bool verbose) {
  std::vector<double> scores, confirmed;
  int alarms = 0;
  for (int i = 0; i < drives; ++i) {
    GeometricRun run = draw_geometric_run(drive(i));
    if (i % 10 >= 5) forget_what_is_told(&run.observations);
    const Largest largest = largest_of(run.observations);
    scores.push_back(largest.score);
    confirmed.push_back(largest.confirmed);
    const bool alarm = says_moved(estimate_maximum_likelihood(run.observations).result);
    alarms += alarm;
    if (verbose || alarm)
      std::printf("  drive %d, %d stops, %zu cameras: score %.1f, step %.1f%s\n", i, drive(i).stops,
                  run.observations.cameras.size(), largest.score, largest.confirmed, alarm ? ", alarm" : "");
  }
  for (auto* values : {&scores, &confirmed}) {
    std::sort(values->begin(), values->end());
    const auto quantile = [values](double q) {
      return (*values)[static_cast<std::size_t>(q * static_cast<double>(values->size() - 1))];
    };
    std::printf("| largest %s | median %.1f | 90 %% %.1f | 99 %% %.1f | 99.9 %% %.1f | most %.1f |\n",
                values == &scores ? "score" : "step", quantile(0.5), quantile(0.9), quantile(0.99), quantile(0.999),
                values->back());
  }
  std::printf("%d healthy drives: %d false alarms\n\n", drives, alarms);
}

struct Moved {
  const char* name;
  int cameras;  // 0: the board
  Vector6d change;
};

bool is_named(const std::vector<Finding>& findings, const Moved& moved, int split) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
    const bool right = moved.cameras == 0 ? finding.code.rfind("board.moved", 0) == 0
                                          : finding.code.rfind("camera.moved", 0) == 0 &&
                                                static_cast<int>(finding.cameras.size()) == moved.cameras;
    return right && !finding.stops.empty() && std::abs(finding.stops.front() - split) <= 1;
  });
}

void detections(int trials, bool verbose) {
  const auto turn = [](double pitch_deg, double yaw_deg) {
    Vector6d change = Vector6d::Zero();
    change[4] = deg_to_rad(pitch_deg);
    change[5] = deg_to_rad(yaw_deg);
    return change;
  };
  const auto shift = [](double x_m, double z_m) {
    Vector6d change = Vector6d::Zero();
    change[0] = x_m;
    change[2] = z_m;
    return change;
  };
  const std::vector<Moved> all = {
      {"one camera pitches by 0.05 deg", 1, turn(0.05, 0.0)}, {"one camera pitches by 0.2 deg", 1, turn(0.2, 0.0)},
      {"one camera pitches by 1 deg", 1, turn(1.0, 0.0)},     {"one camera pitches by 5 deg", 1, turn(5.0, 0.0)},
      {"one camera turns by 0.2 deg", 1, turn(0.0, 0.2)},     {"one camera turns by 1 deg", 1, turn(0.0, 1.0)},
      {"one camera forward by 5 mm", 1, shift(0.005, 0.0)},   {"one camera forward by 50 mm", 1, shift(0.05, 0.0)},
      {"three cameras pitch by 0.5 deg", 3, turn(0.5, 0.0)},  {"three cameras turn by 2 deg", 3, turn(0.0, 2.0)},
      {"the board leans by 1 deg", 0, turn(1.0, 0.0)},        {"the board sinks by 20 mm", 0, shift(0.0, 0.02)},
      {"the board turns by 5 deg", 0, turn(0.0, 5.0)},
  };
  std::printf("| moved at half time | runs | found | named first, at the stop | solved |\n|---|---|---|---|---|\n");
  for (const Moved& moved : all) {
    int found = 0, named = 0, solved = 0;
    for (int i = 0; i < trials; ++i) {
      GeometricConfig config;
      config.seed = static_cast<std::uint64_t>(i);
      config.stops = i % 2 == 0 ? 20 : 40;
      config.declare_odometry_model = config.declare_odometry_sigmas = i % 4 < 2;
      const int split = config.stops / 2;
      const GeometricRun run = moved.cameras == 0 ? draw_board_moved_during(config, split, moved.change)
                                                  : draw_moved_during(config, split,
                                                                      moved.cameras == 1 ? std::vector<int>{i % 3}
                                                                                         : std::vector<int>{0, 1, 2},
                                                                      moved.change);
      const Result result = estimate_maximum_likelihood(run.observations).result;
      found += says_moved(result);
      const bool first =
          is_named(result.reasons.empty() ? result.notes : std::vector<Finding>{result.reasons.front()}, moved, split);
      named += first;
      solved += result.status == ResultStatus::kSolved;
      if (verbose && !first)
        std::printf("  trial %d: %s\n", i,
                    findings_json(result.reasons.empty() ? result.notes : result.reasons).c_str());
    }
    std::printf("| %s | %d | %d | %d | %d |\n", moved.name, trials, found, named, solved);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace rigproof

int main(int count, char** arguments) {
  int drives = 1000, trials = 40;
  bool verbose = false;
  const auto declare = [&](CLI::App& app) {
    rigproof::add_count(app, "drives", drives)->description("healthy ones");
    rigproof::add_count(app, "trials", trials)->description("of each size");
    app.add_flag("--verbose", verbose);
  };
  return rigproof::bench_main(count, arguments, "Cameras, or the board, that were moved during the drive", declare,
                              [&] {
                                if (drives > 0) rigproof::healthy(drives, verbose);
                                if (trials > 0) rigproof::detections(trials, verbose);
                                return 0;
                              });
}
