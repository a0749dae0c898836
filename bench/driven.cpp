// How true the estimator's uncertainty is on odometry that was driven: physics makes the drives, corners and planes are
// drawn from the noise model, nothing is told. Try --help.
#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench_main.h"
#include "calibration_truth.h"
#include "odometry_track.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/geometric/geometric.h"
#include "rigproof/words/sentences.h"
#include "scenario.h"

namespace {

namespace fs = std::filesystem;
using namespace rigproof;

struct Options {
  int runs = 20, poses = 30;
  std::uint64_t seed = 1;
  std::string folder;
  std::vector<std::string> lines;
  bool chord = false;
};

// What observe() would make of the odometry.
std::vector<Stop> stops_of(const std::vector<TrueStop>& truth, const std::vector<OdometrySample>& odometry) {
  constexpr double kMaxGap_s = 0.5, kNearest_s = 0.02;
  const detection::OdometryTrack track(odometry, kMaxGap_s, kNearest_s);
  std::vector<Stop> stops;
  for (const TrueStop& stop : truth) {
    Finding why_not;
    const std::optional<detection::OdometryReading> reading = track.at(stop.stamp_s, &why_not);
    if (!reading) throw Error(words::sentence_of(why_not));
    stops.push_back({stop.stamp_s, reading->x_m, reading->y_m, reading->yaw_rad, reading->sigma_m, {}});
    if (stops.size() > 1) stops.back().way = track.way(stops[stops.size() - 2], stops.back());
  }
  return stops;
}

GeometricRun drive(const Options& options, std::uint64_t seed) {
  GenerateConfig config = parse_generate_config(
      "include: plain.yaml\nmotion: drive\nseed: " + std::to_string(seed) + "\n" + joined(options.lines, "\n"),
      "arguments");
  config.poses = options.poses;
  const Scenario scenario = resolve_scenario(config);
  GeometricConfig geometric;
  geometric.seed = seed;
  geometric.rig.cameras = scenario.recording.rig.cameras;
  geometric.rig.board = scenario.truth.board;
  geometric.rig.T_robot_camera.clear();
  for (const TrueCamera& camera : scenario.truth.cameras) geometric.rig.T_robot_camera.push_back(camera.T_robot_camera);
  geometric.declare_odometry_model = geometric.declare_odometry_sigmas = false;
  GeometricScene scene{scenario.truth.T_world_board, {}, {}};
  for (const TrueBoard& board : scenario.truth.more_boards)
    scene.more_boards.push_back({board.board, board.T_world_board, {}});
  for (const TrueStop& stop : scenario.truth.stops) scene.T_world_robot.push_back(stop.T_world_robot);
  GeometricRun run = draw_geometric_run(geometric, scene);
  run.truth.stops = scenario.truth.stops;
  run.observations.stops = stops_of(scenario.truth.stops, scenario.recording.odometry);
  return run;
}

GeometricRun saved_or_driven(const Options& options, std::uint64_t seed) {
  if (options.folder.empty()) return drive(options, seed);
  const fs::path observations = fs::path(options.folder) / (std::to_string(seed) + ".json");
  const fs::path truth = fs::path(options.folder) / (std::to_string(seed) + "_truth.yaml");
  if (fs::exists(observations) && fs::exists(truth)) return {load_observations(observations), load_truth(truth)};
  fs::create_directories(options.folder);
  const GeometricRun run = drive(options, seed);
  save_truth(run.truth, truth);
  save_observations(run.observations, observations);
  return run;
}

struct Sums {
  int solved = 0;
  double nees = 0.0, nees2 = 0.0;
  Vector6d z2 = Vector6d::Zero(), error2 = Vector6d::Zero();
};

void evaluate(const GeometricRun& run, std::uint64_t seed, Sums* sums) {
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
  const char* model = estimate.odometry.along_way ? "along the way" : odometry_model_name(estimate.odometry.model);
  std::printf("%4llu %-13s lnL %6.1f  s %.4f k %.4f  %5.2f mm %.3f deg", static_cast<unsigned long long>(seed), model,
              estimate.odometry.log_likelihood_ratio, estimate.state.odometry_scale, estimate.state.odometry_yaw_factor,
              1e3 * estimate.noise.odometry_xy_m, rad_to_deg(estimate.noise.odometry_yaw_rad));
  if (estimate.result.status != ResultStatus::kSolved || !estimate.result.joint_covariance) {
    std::printf("  refused: %s\n", words::text_of(estimate.result.reasons).c_str());
    return;
  }
  const Vector6d error =
      transform_error(estimate.state.T_robot_camera.front(), run.truth.cameras.front().T_robot_camera);
  const Vector6d sigma = estimate.result.joint_covariance->diagonal().head<6>().cwiseSqrt();
  const double value = nees(estimate, poses_of(run.truth));
  std::printf("  tx %+.2f+-%.2f ty %+.2f+-%.2f cm yaw %+.3f+-%.3f deg  NEES %.1f\n", 100.0 * error[0], 100.0 * sigma[0],
              100.0 * error[1], 100.0 * sigma[1], rad_to_deg(error[5]), rad_to_deg(sigma[5]), value);
  ++sums->solved;
  sums->nees += value;
  sums->nees2 += value * value;
  sums->error2 += error.cwiseAbs2();
  sums->z2 += error.cwiseQuotient(sigma).cwiseAbs2();
}

void report(const Sums& sums, const Options& options) {
  std::printf("%d of %d solved\n", sums.solved, options.runs);
  if (sums.solved == 0) return;
  const double n = sums.solved, mean = sums.nees / n;
  const double spread = std::sqrt(std::max(0.0, sums.nees2 / n - mean * mean) / n);
  std::printf("NEES %.1f +- %.1f (99 %%)\n", mean, 2.576 * spread);
  std::printf("first camera, rms of tx ty tz [cm] rx ry rz [deg]:");
  for (int axis = 0; axis < 6; ++axis) {
    const double rms = std::sqrt(sums.error2[axis] / n);
    std::printf(" %.4f", axis < 3 ? 100.0 * rms : rad_to_deg(rms));
  }
  std::printf("\nrms of errors in standard deviations:");
  for (int axis = 0; axis < 6; ++axis) std::printf(" %.2f", std::sqrt(sums.z2[axis] / n));
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  const auto declare = [&](CLI::App& app) {
    add_count(app, "--runs", options.runs);
    add_count(app, "--poses", options.poses);
    app.add_option("--seed", options.seed, "of the first drive");
    app.add_option("--save", options.folder, "keeps the drives, and reads those that are there");
    app.add_flag("--chord", options.chord, "the odometry's rows between the stops are not used");
    app.add_option("lines", options.lines,
                   "of the run's configuration: \"scene: corridor\", \"drive: {friction: 0.3}\"");
  };
  return bench_main(count, arguments, "Drives of physics: errors in standard deviations, NEES", declare, [&] {
    Sums sums;
    for (int i = 0; i < options.runs; ++i) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
      GeometricRun run = saved_or_driven(options, seed);
      for (Stop& stop : run.observations.stops)
        if (options.chord) stop.way.clear();
      evaluate(run, seed, &sums);
      std::fflush(stdout);
    }
    report(sums, options);
    return 0;
  });
}
