// How often the estimator refuses what it must, names the cause, and lets healthy runs pass: the tables of
// docs/measurements/refusals.md, over random rigs in geometric mode.
//   bench_refusals [--broken 100] [--degenerate 200] [--healthy 1000] [--seed 0] [--only NAME] [--verbose]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bench_main.h"
#include "broken_runs.h"
#include "calibration_truth.h"
#include "lens_check.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/declared_problem.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/words/sentences.h"

namespace {

using namespace rigproof;

struct Options {
  int broken = 100, degenerate = 200, healthy = 1000;
  std::uint64_t seed = 0;
  std::string only;
  bool verbose = false;
};

bool wanted(const Options& options, const std::string& name) {
  return options.only.empty() || name.find(options.only) != std::string::npos;
}

std::string first_reason(const Result& result) {
  const std::vector<std::string> reasons = words::sentences_of(result.reasons);
  return reasons.empty() ? "" : reasons.front();
}

struct Rates {
  int detected = 0, named = 0, wrong = 0, runs = 0;
};

void print(const char* name, const Rates& rates) {
  std::printf("| %s | %d | %.1f %% | %.1f %% | %d |\n", name, rates.runs, 100.0 * rates.detected / rates.runs,
              100.0 * rates.named / rates.runs, rates.wrong);
  std::fflush(stdout);
}

const Rigid3& true_pose(const Truth& truth, const std::string& camera) {
  for (const TrueCamera& c : truth.cameras)
    if (c.name == camera) return c.T_robot_camera;
  throw Error("no camera " + camera + " in the truth");
}

// A value that stands though it is off by more than six of its stated standard deviations, and by more than a tenth of
// a millimetre or a thousandth of a degree: where there is no noise, there is rounding.
bool silently_wrong(const Options& options, const EstimatedTransform& stated, const Rigid3& truth, bool in_robot) {
  constexpr double kSigmas = 6.0, kLeast_m = 1e-4, kLeast_rad = 2e-5;
  EstimatedTransform transform = stated, right = stated;
  right.T_parent_child = truth;
  right.covariance.reset();
  // Without a heading roll and pitch are judged in the camera's own axes.
  if (in_robot) transform = heading_free(transform), right = heading_free(right);
  const Vector6d error = transform_error(transform.T_parent_child, right.T_parent_child).cwiseAbs();
  for (int axis = 0; axis < 6; ++axis) {
    if (!transform.observable[static_cast<std::size_t>(axis)] || !transform.covariance) continue;
    const double sigma = std::sqrt((*transform.covariance)(axis, axis));
    if (error[axis] < kSigmas * sigma || error[axis] < (axis < 3 ? kLeast_m : kLeast_rad)) continue;
    if (options.verbose)
      std::printf("  %s in %s, axis %d: off by %.3g, sigma %.3g\n", transform.child.c_str(), transform.parent.c_str(),
                  axis, error[axis], sigma);
    return true;
  }
  return false;
}

bool silently_wrong(const Options& options, const Result& result, const Truth& truth) {
  return std::any_of(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                     [&](const EstimatedTransform& t) {
                       return silently_wrong(options, t, true_pose(truth, t.child), true);
                     }) ||
         std::any_of(result.camera_to_camera.begin(), result.camera_to_camera.end(), [&](const EstimatedTransform& t) {
           return silently_wrong(options, t, true_pose(truth, t.parent).inverse() * true_pose(truth, t.child), false);
         });
}

void complain(const Options& options, std::uint64_t seed, const Result& result) {
  if (!options.verbose) return;
  std::printf("  seed %llu: %s", static_cast<unsigned long long>(seed), result_status_name(result.status));
  for (const std::string& reason : words::sentences_of(result.reasons)) std::printf("\n    %s", reason.c_str());
  for (const std::string& note : words::sentences_of(result.notes)) std::printf("\n    note: %s", note.c_str());
  std::printf("\n");
}

// What is marked unusable: x, y and yaw in the robot at least.
bool unusable(const Result& result) {
  if (result.status == ResultStatus::kSolved) return false;
  for (const EstimatedTransform& transform : result.camera_to_robot)
    if (transform.observable[0] || transform.observable[1] || transform.observable[5]) return false;
  return true;
}

bool mentioned(const std::vector<Finding>& findings, const std::string& what) {
  for (const std::string& sentence : words::sentences_of(findings))
    if (sentence.find(what) != std::string::npos) return true;
  return false;
}

// The chance that half a pixel in x and y shows: the most powerful test at the same threshold, which knows the truth,
// the noise and what to look for.
double chance_of_seeing_half_a_pixel(const GeometricRun& run) {
  CalibrationNoise noise = noise_of(run.truth);
  const ml::Priors stated = ml::Priors::of({run.observations, noise.priors, false});
  noise.priors.focal_relative = ml::kDoubtedFocal;
  noise.priors.principal_point_px = ml::kDoubtedPrincipalPoint_px;
  const auto test =
      ml::test_lenses(ml::declared_problem(run.observations, noise), ml::none_removed(run.observations, noise.priors),
                      stated, ml::state_from(state_of(run.truth)));
  if (!test) return 0.0;
  const Eigen::Vector3d slip(0.0, 0.5, 0.5);
  const double deviations = std::sqrt(slip.dot(test->common_shift.information * slip));
  return 0.5 * std::erfc((ml::kLensMinDeviations - deviations) / std::sqrt(2.0));
}

void bench_broken(const Options& options) {
  std::printf("| wrong | runs | detected | named first | silently wrong |\n|---|---|---|---|---|\n");
  for (const Breakage& breakage : breakages()) {
    if (!wanted(options, breakage.name)) continue;
    const bool half_pixel = std::string(breakage.name).find("half-pixel") != std::string::npos;
    double chance = 0.0;
    Rates rates;
    for (int i = 0; i < options.broken; ++i) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
      GeometricRun run = draw_geometric_run(broken_run_config(breakage, seed));
      Observations& observations = run.observations;
      if (half_pixel) chance += chance_of_seeing_half_a_pixel(run) / options.broken;
      const std::string cause = breakage.apply(seed, &observations);
      const Result result = estimate_maximum_likelihood(observations).result;
      const bool in_notes = breakage.named_in == NamedIn::kNotes;
      const bool named = in_notes ? mentioned(result.notes, cause) || mentioned(result.reasons, cause)
                                  : first_reason(result).find(cause) != std::string::npos;
      const bool detected = in_notes ? named || unusable(result) : unusable(result);
      ++rates.runs;
      rates.detected += detected;
      rates.named += named;
      const bool wrong = silently_wrong(options, result, run.truth);
      rates.wrong += wrong;
      if (!detected || !named || wrong) complain(options, seed, result);
    }
    print(breakage.name, rates);
    if (half_pixel) std::printf("| at most, by a test at the truth | | %.1f %% | | |\n", 100.0 * chance);
  }
}

struct Drive {
  const char* name;
  GeometricDrive drive;
  int stops;
  bool ground;
  const char* words;
};

void bench_degenerate(const Options& options) {
  const Drive drives[] = {{"straight line", GeometricDrive::kStraight, 15, true, "straight"},
                          {"rotation in place", GeometricDrive::kTurnInPlace, 15, true, "turned in place"},
                          {"constant-radius arc", GeometricDrive::kArc, 15, true, "one centre"},
                          {"standstill", GeometricDrive::kStandstill, 15, true, "stood still"},
                          {"N = 1", GeometricDrive::kRandom, 1, true, "1 usable pose"},
                          {"N = 2", GeometricDrive::kRandom, 2, true, "usable pose"},
                          {"no ground", GeometricDrive::kRandom, 20, false, "no ground"}};
  std::printf("| drive | runs | refused | right reason first | silently wrong |\n|---|---|---|---|---|\n");
  for (const Drive& drive : drives) {
    if (!wanted(options, drive.name)) continue;
    Rates rates;
    for (int i = 0; i < options.degenerate; ++i) {
      GeometricConfig config;
      config.seed = options.seed + static_cast<std::uint64_t>(i);
      config.rig = random_rig(config.seed, 1 + i % 4);
      config.drive = drive.drive;
      config.stops = drive.stops;
      config.ground = drive.ground;
      config.lambda = (i / 2) % 2;
      config.declare_odometry_model = config.declare_odometry_sigmas = i % 2 == 0;
      const GeometricRun run = draw_geometric_run(config);
      const Result result = estimate_maximum_likelihood(run.observations).result;
      const bool named = first_reason(result).find(drive.words) != std::string::npos;
      const bool refused = result.status != ResultStatus::kSolved && !result.joint_covariance;
      ++rates.runs;
      rates.detected += refused;
      rates.named += named;
      const bool wrong = silently_wrong(options, result, run.truth);
      rates.wrong += wrong;
      const bool odd = mentioned(result.notes, "nan") || has_code(result.notes, "solver.unsettled");
      if (!refused || !named || wrong || odd) complain(options, config.seed, result);
    }
    print(drive.name, rates);
  }
}

// How far beyond what the data can tell an absent value lies: the bound at the truth over the limit of gate 2, the
// least of all absent values. Undeclared odometry counts with the paper's nominal noise: before the data nobody knows
// better.
double least_bound_over_limit(const Result& result, const GeometricRun& run) {
  CalibrationNoise noise = noise_of(run.truth);
  const CalibrationNoise nominal;
  const OdometryNoise& declared = run.observations.odometry_noise;
  if (!declared.sigma_xy_m) noise.odometry_xy_m = nominal.odometry_xy_m;
  if (!declared.sigma_yaw_rad) noise.odometry_yaw_rad = nominal.odometry_yaw_rad;
  const InformationBound bound = cramer_rao_bound(run.observations, state_of(run.truth), noise);
  const PosteriorLimits limits;
  const auto index = [&](const std::string& name) {
    std::size_t c = 0;
    while (c < run.truth.cameras.size() && run.truth.cameras[c].name != name) ++c;
    return c;
  };
  double least = 1e9;
  const auto look = [&](const EstimatedTransform& transform, const Matrix6d& covariance,
                        const std::array<double, 6>& limit) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (transform.observable[axis]) continue;
      const Eigen::Index i = static_cast<Eigen::Index>(axis);
      least = std::min(least, std::sqrt(covariance(i, i)) / limit[axis]);
    }
  };
  for (const EstimatedTransform& transform : result.camera_to_robot)
    look(transform, bound.camera_to_robot[index(transform.child)],
         {limits.xy_m, limits.xy_m, limits.z_m, limits.tilt_rad, limits.tilt_rad, limits.yaw_rad});
  for (const EstimatedTransform& transform : result.camera_to_camera)
    for (const InformationBound::Pair& pair : bound.camera_to_camera)
      if (run.truth.cameras[static_cast<std::size_t>(pair.parent)].name == transform.parent &&
          run.truth.cameras[static_cast<std::size_t>(pair.child)].name == transform.child)
        look(transform, pair.covariance,
             {limits.xy_m, limits.xy_m, limits.xy_m, limits.yaw_rad, limits.yaw_rad, limits.yaw_rad});
  return least;
}

// Whether every reason is that the data do not tell enough; no contradiction, no cause.
bool only_too_little(const Result& result) {
  return !result.reasons.empty() && std::all_of(result.reasons.begin(), result.reasons.end(), [](const auto& reason) {
    return reason.severity == Severity::kRefusal;
  });
}

struct HealthyCell {
  int runs = 0, false_alarms = 0, withheld = 0, limited = 0, wrong = 0;
  double least = 1e9;
};

// A false alarm blames something that is right. Values that are absent for being too uncertain are limited by the data
// where the bound says so too, and withheld where the bound lies well within the limit: the estimator does not know the
// noise, or how the cameras hang together, as the truth does.
void add_healthy(const Options& options, const GeometricConfig& config, HealthyCell* cell) {
  constexpr double kWithin = 0.7;  // of the limit: what is stated scatters about the bound
  const GeometricRun run = draw_geometric_run(config);
  const Result result = estimate_maximum_likelihood(run.observations).result;
  ++cell->runs;
  const bool wrong = silently_wrong(options, result, run.truth);
  cell->wrong += wrong;
  if (wrong && options.verbose) std::printf("  silently wrong:\n");
  if (result.status != ResultStatus::kSolved) {
    const double least = least_bound_over_limit(result, run);
    if (options.verbose) std::printf("  bound / limit %.2f:\n", least);
    if (!only_too_little(result)) {
      ++cell->false_alarms;
    } else {
      (least < kWithin ? cell->withheld : cell->limited) += 1;
      cell->least = std::min(cell->least, least);
    }
  }
  if (wrong || result.status != ResultStatus::kSolved) complain(options, config.seed, result);
}

void bench_healthy(const Options& options) {
  std::printf(
      "| healthy | runs | false alarms | withheld | limited | least bound / limit of what is absent | silently wrong "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  for (const int stops : {5, 7, 10, 20}) {
    for (const bool declared : {true, false}) {
      for (const bool random : {false, true}) {
        const std::string name = std::to_string(stops) + " stops, " + (declared ? "declared" : "undeclared") +
                                 (random ? ", random rigs" : ", reference rig");
        if (!wanted(options, name)) continue;
        HealthyCell cell;
        for (int i = 0; i < options.healthy / 16; ++i) {
          GeometricConfig config;
          config.seed = options.seed + static_cast<std::uint64_t>(i);
          if (random) config.rig = random_rig(config.seed, 1 + i % 4);
          config.stops = stops;
          config.lambda = i % 2;
          config.board_planes = i % 4 < 2;
          config.depth_scale_sigma = config.board_planes ? 0.01 : 0.0;
          config.declare_odometry_model = config.declare_odometry_sigmas = declared;
          add_healthy(options, config, &cell);
        }
        const std::string least = cell.least < 1e9 ? fixed_text(cell.least, 2) : "";
        std::printf("| %s | %d | %d | %d | %d | %s | %d |\n", name.c_str(), cell.runs, cell.false_alarms, cell.withheld,
                    cell.limited, least.c_str(), cell.wrong);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  const auto declare = [&](CLI::App& app) {
    add_count(app, "--broken", options.broken);
    add_count(app, "--degenerate", options.degenerate);
    add_count(app, "--healthy", options.healthy);
    app.add_option("--seed", options.seed);
    app.add_option("--only", options.only, "rows whose name has this");
    app.add_flag("--verbose", options.verbose);
  };
  return bench_main(count, arguments, "What is refused, and how rightly", declare, [&] {
    if (options.broken > 0) bench_broken(options);
    if (options.degenerate > 0) bench_degenerate(options);
    if (options.healthy > 0) bench_healthy(options);
    return 0;
  });
}
