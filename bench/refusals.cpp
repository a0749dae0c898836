// How often the estimator refuses what it must, names the cause, and lets healthy runs pass: the tables of
// docs/estimation.md, over random rigs in geometric mode.
//   bench_refusals [--broken 100] [--degenerate 200] [--healthy 1000] [--seed 0] [--only NAME] [--verbose]
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "broken_runs.h"
#include "rigproof/calib/ml.h"
#include "rigproof/core/error.h"

namespace {

using namespace rigproof;

struct Options {
  int broken = 100, degenerate = 200, healthy = 1000;
  std::uint64_t seed = 0;
  std::string only;
  bool verbose = false;
};

Options parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    const auto value = [&]() -> const char* { return i + 1 < count ? arguments[++i] : ""; };
    if (name == "--broken")
      options.broken = std::atoi(value());
    else if (name == "--degenerate")
      options.degenerate = std::atoi(value());
    else if (name == "--healthy")
      options.healthy = std::atoi(value());
    else if (name == "--seed")
      options.seed = static_cast<std::uint64_t>(std::atoll(value()));
    else if (name == "--only")
      options.only = value();
    else if (name == "--verbose")
      options.verbose = true;
    else
      throw Error("unknown option " + name);
  }
  return options;
}

bool wanted(const Options& options, const std::string& name) {
  return options.only.empty() || name.find(options.only) != std::string::npos;
}

std::string first_reason(const Result& result) { return result.reasons.empty() ? "" : result.reasons.front(); }

struct Rates {
  int detected = 0, named = 0, runs = 0;
};

void print(const char* name, const Rates& rates) {
  std::printf("| %s | %d | %.1f %% | %.1f %% |\n", name, rates.runs, 100.0 * rates.detected / rates.runs,
              100.0 * rates.named / rates.runs);
  std::fflush(stdout);
}

void complain(const Options& options, std::uint64_t seed, const Result& result) {
  if (!options.verbose) return;
  std::printf("  seed %llu: %s", static_cast<unsigned long long>(seed), result_status_name(result.status));
  for (const std::string& reason : result.reasons) std::printf("\n    %s", reason.c_str());
  for (const std::string& note : result.notes) std::printf("\n    note: %s", note.c_str());
  std::printf("\n");
}

// What is marked unusable: x, y and yaw in the robot at least.
bool unusable(const Result& result) {
  if (result.status == ResultStatus::kSolved) return false;
  for (const EstimatedTransform& transform : result.camera_to_robot)
    if (transform.observable[0] || transform.observable[1] || transform.observable[5]) return false;
  return true;
}

bool mentioned(const std::vector<std::string>& sentences, const std::string& words) {
  for (const std::string& sentence : sentences)
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

void bench_broken(const Options& options) {
  std::printf("| wrong | runs | detected | named first |\n|---|---|---|---|\n");
  for (const Breakage& breakage : breakages()) {
    if (!wanted(options, breakage.name)) continue;
    Rates rates;
    for (int i = 0; i < options.broken; ++i) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
      Observations observations = draw_geometric_run(broken_run_config(breakage, seed)).observations;
      const std::string words = breakage.apply(seed, &observations);
      const Result result = estimate_maximum_likelihood(observations).result;
      const bool in_notes = breakage.named_in == NamedIn::kNotes;
      const bool named = in_notes ? mentioned(result.notes, words) || mentioned(result.reasons, words)
                                  : first_reason(result).find(words) != std::string::npos;
      const bool detected = in_notes ? named || unusable(result) : unusable(result);
      ++rates.runs;
      rates.detected += detected;
      rates.named += named;
      if (!detected || !named) complain(options, seed, result);
    }
    print(breakage.name, rates);
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
  std::printf("| drive | runs | refused | right reason first |\n|---|---|---|---|\n");
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
      const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
      const bool named = first_reason(result).find(drive.words) != std::string::npos;
      const bool refused = result.status != ResultStatus::kSolved && !result.joint_covariance;
      ++rates.runs;
      rates.detected += refused;
      rates.named += named;
      const bool odd = mentioned(result.notes, "nan") || mentioned(result.notes, "settle");
      if (!refused || !named || odd) complain(options, config.seed, result);
    }
    print(drive.name, rates);
  }
}

void bench_healthy(const Options& options) {
  std::printf("| healthy | runs | refused |\n|---|---|---|\n");
  for (const int stops : {5, 7, 10, 20}) {
    for (const bool declared : {true, false}) {
      for (const bool random : {false, true}) {
        const std::string name = std::to_string(stops) + " stops, " + (declared ? "declared" : "undeclared") +
                                 (random ? ", random rigs" : ", reference rig");
        if (!wanted(options, name)) continue;
        int refused = 0, runs = 0;
        for (int i = 0; i < options.healthy / 16; ++i, ++runs) {
          GeometricConfig config;
          config.seed = options.seed + static_cast<std::uint64_t>(i);
          if (random) config.rig = random_rig(config.seed, 1 + i % 4);
          config.stops = stops;
          config.lambda = i % 2;
          config.board_planes = i % 4 < 2;
          config.depth_scale_sigma = config.board_planes ? 0.01 : 0.0;
          config.declare_odometry_model = config.declare_odometry_sigmas = declared;
          const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
          if (result.status == ResultStatus::kSolved) continue;
          ++refused;
          complain(options, config.seed, result);
        }
        std::printf("| %s | %d | %d |\n", name.c_str(), runs, refused);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const Options options = parse(count, arguments);
    if (options.broken > 0) bench_broken(options);
    if (options.degenerate > 0) bench_degenerate(options);
    if (options.healthy > 0) bench_healthy(options);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code());
  }
  return 0;
}
