// Rendered robots that nobody here built, each calibrated with the defaults and compared with its truth: the table of
// docs/measurements/estimation.md.
//   bench_strangers [--data FOLDER] [--robots 60] [--first 0] [--stops 24] [--image-scale 0.5] [--jobs N]
// What was rendered stays in FOLDER for the next time; without one it goes into a temporary folder. Exit code 1 where
// the pooled NEES lies outside its 99 % interval.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "bench_main.h"
#include "nees_pool.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/study/sweep/observed_run.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "rigproof/validate/validate.h"
#include "strangers_robots.h"

namespace {

using namespace rigproof;
namespace fs = std::filesystem;

struct Options {
  std::string data;
  int robots = 60, first = 0, stops = 24, jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  double image_scale = 0.5;
};

/// What came out of one robot.
struct Row {
  std::string status = "error", summary, worst, said;
  double nees = 0.0, worst_z = 0.0;
  int unknowns = 0;
};

void look(const TransformError& error, Row* row) {
  for (int axis = 0; axis < 6; ++axis) {
    const std::optional<double> z = error.z(axis);
    if (!z || std::abs(*z) <= row->worst_z) continue;
    row->worst_z = std::abs(*z);
    row->worst = error.name() + ", " + kDegreeOfFreedomNames[static_cast<std::size_t>(axis)];
  }
}

Row row_of(const Result& result, const Truth& truth) {
  const Comparison comparison = compare(result, truth);
  Row row;
  row.status = result_status_name(result.status);
  if (comparison.nees) row.nees = *comparison.nees;
  if (comparison.nees) row.unknowns = comparison.nees_degrees_of_freedom;
  for (const auto* errors : {&comparison.camera_to_robot, &comparison.camera_to_camera})
    for (const TransformError& error : *errors) look(error, &row);
  std::vector<std::string> codes;
  for (const std::vector<Finding>* findings : {&result.reasons, &result.notes})
    for (const Finding& finding : *findings)
      if (finding.severity != Severity::kNote && finding.severity != Severity::kLeftOut) codes.push_back(finding.code);
  row.said = joined(codes, " ");
  return row;
}

Row calibrate_robot(const bench::StrangersRobot& robot, const fs::path& run) {
  const fs::path rig = run.string() + ".rig.yaml";
  write_file_atomically_unsynced(rig, robot.rig);
  GenerateOptions options;
  options.output = run;
  options.jobs = 1;
  const auto scenario =
      prepare_generation(parse_generate_config(robot.run + "rig: \"" + rig.string() + "\"\n", "robot"), options);
  const Observations observations = generate_observed(*scenario, options).observations;
  const Result result = run_method(default_method(), {observations, nullptr, 1});
  return row_of(result, load_truth(RunFolder{run}.truth_file()));
}

std::string text_of(const Row& row) {
  return joined({row.status, number_text(row.nees), std::to_string(row.unknowns), number_text(row.worst_z), row.worst,
                 row.said, row.summary},
                "\t");
}

Row row_from(const std::string& text) {
  std::vector<std::string> parts(7);
  std::istringstream stream(text);
  for (std::string& part : parts) std::getline(stream, part, '\t');
  Row row;
  row.status = parts[0];
  row.nees = parse_number(parts[1]).value_or(0.0);
  row.unknowns = static_cast<int>(parse_number(parts[2]).value_or(0.0));
  row.worst_z = parse_number(parts[3]).value_or(0.0);
  row.worst = parts[4];
  row.said = parts[5];
  row.summary = parts[6];
  return row;
}

struct Robots {
  Options options;
  fs::path data;

  fs::path run(int i) const { return data / ("robot-" + std::to_string(options.first + i)); }
  fs::path row_file(int i) const { return run(i).string() + ".row"; }
};

void calibrate_and_keep(const Robots& robots, int i) {
  const auto number = static_cast<std::uint64_t>(robots.options.first + i);
  const bench::StrangersRobot robot = bench::strangers_robot(number, robots.options.stops, robots.options.image_scale);
  Row row;
  fs::remove(robots.row_file(i));  // of before: a worker that dies leaves none
  try {
    row = calibrate_robot(robot, robots.run(i));
  } catch (const Error& error) {
    row.said = error.what();
    std::replace_if(
        row.said.begin(), row.said.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
  }
  row.summary = robot.summary;
  write_file_atomically_unsynced(robots.row_file(i), text_of(row));
}

// Renderers are processes of their own, which threads may not start: each worker is one, too.
void calibrate_all(const Robots& robots) {
  std::vector<pid_t> workers;
  for (int worker = 0; worker < std::max(1, robots.options.jobs); ++worker) {
    const pid_t child = ::fork();
    if (child < 0) throw Error("no process could be started");
    if (child > 0) {
      workers.push_back(child);
      continue;
    }
    for (int i = worker; i < robots.options.robots; i += std::max(1, robots.options.jobs))
      calibrate_and_keep(robots, i);
    ::_exit(0);
  }
  for (const pid_t worker : workers) ::waitpid(worker, nullptr, 0);
}

int print(const Robots& robots) {
  std::map<std::string, bench::NeesPool> pools;
  bench::NeesPool all, unsuspected;
  int beyond = 0;
  for (int i = 0; i < robots.options.robots; ++i) {
    if (!fs::exists(robots.row_file(i))) throw Error(robots.row_file(i).string() + ": the worker has died");
    const Row row = row_from(read_text_file(robots.row_file(i)));
    std::printf("%4d  %-8s  NEES %7.2f of %2d  largest z %5.2f %-28s %s  [%s]\n", robots.options.first + i,
                row.status.c_str(), row.nees, row.unknowns, row.worst_z, row.worst.c_str(), row.summary.c_str(),
                row.said.c_str());
    all.add(row.nees, row.unknowns);
    if (row.said.empty()) unsuspected.add(row.nees, row.unknowns);
    pools[row.status].add(row.nees, row.unknowns);
    beyond += row.worst_z > 5.0 && row.said.empty();
  }
  std::printf("\n");
  for (const auto& [status, pool] : pools) {
    if (pool.unknowns == 0)
      std::printf("%-12s %3d robots\n", status.c_str(), pool.runs);
    else
      bench::print_pool(status, pool);
  }
  bench::print_pool("unsuspected", unsuspected);
  const bool holds = bench::print_pool("all", all);
  std::printf("%d beyond five sigmas without a word\n", beyond);
  return static_cast<int>(holds && beyond == 0 ? ExitCode::kGood : ExitCode::kGateFailed);
}

int measure(const Options& options) {
  std::optional<ScratchFolder> scratch;
  if (options.data.empty()) scratch.emplace("bench-strangers");
  const Robots robots{options, scratch ? scratch->path() : fs::absolute(options.data)};
  fs::create_directories(robots.data);
  bench::write_sensors(robots.data / "sensors");
  const char* const path = std::getenv("RIGPROOF_PATH");
  ::setenv("RIGPROOF_PATH", ((robots.data / "sensors").string() + (path ? ":" + std::string(path) : "")).c_str(), 1);
  calibrate_all(robots);
  return print(robots);
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  const auto declare = [&](CLI::App& app) {
    app.add_option("--data", options.data, "where drives are rendered and stay; without it a temporary folder");
    add_count(app, "--robots", options.robots);
    add_count(app, "--first", options.first);
    add_count(app, "--stops", options.stops);
    add_count(app, "--jobs", options.jobs);
    app.add_option("--image-scale", options.image_scale)->check(CLI::NonNegativeNumber);
  };
  return bench_main(count, arguments, "Rendered robots that nobody here built, compared with their truth", declare,
                    [&] { return measure(options); });
}
