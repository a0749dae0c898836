// How near the estimator comes to the Cramer-Rao bound: RMSE over bound per axis with its 99 % limits, NEES, refusals
// and time, over many geometric runs. Try --help.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "bench_main.h"
#include "estimation_cells.h"
#include "estimation_report.h"
#include "rigproof/core/error.h"

namespace {

using namespace rigproof;
using namespace rigproof::bench;

constexpr const char* kHelp =
    R"(bench_estimation [--trials 200] [--stops 10,20,50,100] [--lambda 0,1,10] [--seed 0]
                 [--model per_increment|per_pose] [--drive random|steps] [--systematics] [--suspension] [--outliers]
                 [--choose-model] [--estimate-sigmas] [--known-odometry] [--cameras N] [--corner-sigma 0.1] [--method ml]
  prints one cell after the other; --cameras draws random rigs.

bench_estimation --suite FOLDER [--trials 2000] [--sheets increment,pose,..] [--stops ..] [--lambda ..] [--seed 0]
  runs the table of docs/measurements/estimation.md, the cheapest cells first, and writes FOLDER/table.csv and table.md;
  "python3 figures/plot.py estimation FOLDER/table.csv" draws them. Cells are saved every few seconds: the same command
  goes on where it was interrupted, and with more trials.
  --trials 0 only writes what was saved.

bench_estimation --convergence RIGS [--seed 0]
  random rigs and board orientations: does the start from the data alone find the optimum that the truth leads to?
)";

struct Options {
  int trials = -1;  // -1: the mode's own
  std::uint64_t seed = 0;
  std::vector<double> stops, lambdas;  // empty: the mode's own
  Sheet sheet;
  std::optional<std::string> suite;
  std::vector<std::string> sheets;
  int convergence = 0;
};

Sheet sheet(const char* name, const char* title, std::initializer_list<bool Sheet::*> switches) {
  Sheet result;
  result.name = name;
  result.title = title;
  for (bool Sheet::*member : switches) result.*member = true;
  return result;
}

// The table of docs/measurements/estimation.md.
std::vector<Sheet> suite_sheets() {
  using S = Sheet;
  return {
      sheet("reference", "Noise per increment, scale and track known to be right", {&S::known_odometry}),
      sheet("increment", "Noise per increment, 2 % scale and 5 % track error", {&S::systematics}),
      sheet("pose", "Noise per pose", {&S::per_pose}),
      sheet("suspension", "Noise per increment, scale and track error, suspension of 1 mm and 0.05 deg",
            {&S::systematics, &S::suspension}),
      sheet("outliers", "Noise per increment, 2 % wrong corners, 5 % wrong odometry, 5 % wrong planes",
            {&S::systematics, &S::outliers}),
      sheet("outliers_pose", "Noise per pose, 2 % wrong corners, 5 % wrong odometry, 5 % wrong planes",
            {&S::per_pose, &S::outliers}),
      sheet("chosen",
            "Nothing declared: odometry model and all sigmas from the data (truth: per increment, suspension)",
            {&S::systematics, &S::suspension, &S::choose_model, &S::estimate_sigmas}),
      sheet("chosen_pose",
            "Nothing declared: odometry model and all sigmas from the data (truth: per pose, suspension)",
            {&S::per_pose, &S::suspension, &S::choose_model, &S::estimate_sigmas}),
  };
}

// Five stops carry a result at little noise only; wrong data need a few more to stand out against. The reference sheet
// is there for its centimetres: a few cells tell them.
bool wanted(const Sheet& sheet, int stops, double lambda) {
  if (sheet.known_odometry && (stops == 10 || stops == 50 || lambda == 2.0 || lambda == 5.0)) return false;
  if (stops == 5) return lambda <= 1.0 && !sheet.outliers && !sheet.choose_model;
  return stops >= 20 || !(sheet.outliers || sheet.choose_model);
}

double cost_of(const CellKey& key) { return key.stops * (key.sheet.estimate_sigmas ? 5.0 : 1.0); }

// Those named, or all.
std::vector<Sheet> wanted_sheets(const std::vector<std::string>& names) {
  const std::vector<Sheet> all = suite_sheets();
  if (names.empty()) return all;
  std::vector<Sheet> found;
  for (const std::string& name : names) {
    const auto same = [&name](const Sheet& candidate) { return candidate.name == name; };
    const auto known = std::find_if(all.begin(), all.end(), same);
    std::string list;
    for (const Sheet& each : all) list += " " + each.name;
    if (known == all.end()) throw Error("--sheets: \"" + name + "\" is none of" + list);
    found.push_back(*known);
  }
  return found;
}

std::vector<CellKey> suite_cells(const Options& options) {
  const std::vector<double> stops = options.stops.empty() ? std::vector<double>{5, 10, 20, 50, 100} : options.stops;
  const std::vector<double> lambdas = options.lambdas.empty() ? std::vector<double>{0, 1, 2, 5, 10} : options.lambdas;
  std::vector<CellKey> keys;
  for (const Sheet& sheet : wanted_sheets(options.sheets)) {
    for (const double n : stops)
      for (const double lambda : lambdas)
        if (wanted(sheet, static_cast<int>(n), lambda))
          keys.push_back({sheet, static_cast<int>(n), lambda, options.seed});
  }
  if (keys.empty()) throw Error("no cell of these sheets has such --stops and --lambda");
  std::stable_sort(keys.begin(), keys.end(),
                   [](const CellKey& a, const CellKey& b) { return cost_of(a) < cost_of(b); });
  return keys;
}

std::atomic<bool> interrupted{false};
void interrupt(int) { interrupted = true; }

// Saves now and then; returns early when interrupted.
Cell run_cell(const CellKey& key, int trials, const std::filesystem::path* folder) {
  constexpr std::chrono::seconds kSaveEvery(10);
  Cell cell = folder != nullptr ? load_cell(*folder, key) : Cell();
  auto saved = std::chrono::steady_clock::now();
  while (cell.trials < trials && !interrupted) {
    add_trial(key, cell.trials, &cell);
    if (folder == nullptr || std::chrono::steady_clock::now() - saved < kSaveEvery) continue;
    save_cell(*folder, key, cell);
    saved = std::chrono::steady_clock::now();
  }
  if (folder != nullptr) save_cell(*folder, key, cell);
  return cell;
}

int run_suite(const Options& options) {
  const std::filesystem::path folder = *options.suite, cells = folder / "cells";
  const int trials = options.trials >= 0 ? options.trials : 2000;
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  const std::vector<CellKey> keys = suite_cells(options);
  Table table;
  for (const CellKey& key : keys) table.emplace_back(key, load_cell(cells, key));
  for (std::size_t i = 0; i < keys.size() && !interrupted; ++i) {
    if (table[i].second.trials >= trials) continue;
    table[i].second = run_cell(keys[i], trials, &cells);
    std::printf("[%zu of %zu] ", i + 1, keys.size());
    print_cell(keys[i], table[i].second);
    write_report(table, folder);
  }
  write_report(table, folder);
  constexpr int kTryAgain = 75;
  if (interrupted) std::fprintf(stderr, "Interrupted; the same command goes on.\n");
  return interrupted ? kTryAgain : 0;
}

void run_cells(const Options& options) {
  const std::vector<double> stops = options.stops.empty() ? std::vector<double>{10, 20, 50, 100} : options.stops;
  const std::vector<double> lambdas = options.lambdas.empty() ? std::vector<double>{0, 1, 10} : options.lambdas;
  for (const double n : stops) {
    for (const double lambda : lambdas) {
      const CellKey key{options.sheet, static_cast<int>(n), lambda, options.seed};
      print_cell(key, run_cell(key, options.trials > 0 ? options.trials : 200, nullptr));
    }
  }
}

// 1 to 8 cameras in any mounting, the board in any orientation.
int run_convergence(const Options& options) {
  int converged = 0, settled = 0;
  for (int i = 0; i < options.convergence; ++i) {
    CellKey key{options.sheet, options.stops.empty() ? 24 : static_cast<int>(options.stops[0]),
                options.lambdas.empty() ? 1.0 : options.lambdas[0], options.seed};
    key.sheet.random_cameras = 1 + i % 8;
    const GeometricConfig config = configuration(key, i);
    const ConvergenceTrial trial = compare_starts(key, config);
    settled += trial.settled ? 1 : 0;
    converged += trial.same_optimum ? 1 : 0;
    if (!trial.same_optimum)
      std::printf("rig %d (%d cameras): cost %.9g from the data, %.9g from the truth\n", i, key.sheet.random_cameras,
                  trial.cost_from_data, trial.cost_from_truth);
    if ((i + 1) % 100 == 0 || i + 1 == options.convergence) {
      std::printf("%d of %d rigs at the optimum, %d settled\n", converged, i + 1, settled);
      std::fflush(stdout);
    }
  }
  return converged == options.convergence ? 0 : 1;
}

void declare_options(CLI::App& app, Options& options) {
  Sheet& sheet = options.sheet;
  app.add_option("--trials", options.trials)->check(CLI::Range(0, 100000000));
  app.add_option("--seed", options.seed);
  app.add_option("--stops", options.stops)->delimiter(',');
  app.add_option("--lambda", options.lambdas)->delimiter(',');
  const auto choose = [&app](const char* name, bool* second, const std::vector<std::string>& names) {
    const auto take = [second, names](const std::string& value) { *second = value == names[1]; };
    app.add_option_function<std::string>(name, take)->check(CLI::IsMember(names));
  };
  choose("--model", &sheet.per_pose, {"per_increment", "per_pose"});
  choose("--drive", &sheet.steps, {"random", "steps"});
  add_count(app, "--cameras", sheet.random_cameras);
  app.add_option("--corner-sigma", sheet.corner_sigma_px);
  app.add_option("--method", sheet.method);
  app.add_option("--suite", options.suite);
  app.add_option("--sheets", options.sheets)->delimiter(',');
  add_count(app, "--convergence", options.convergence);
  app.add_flag("--systematics", sheet.systematics);
  app.add_flag("--suspension", sheet.suspension);
  app.add_flag("--outliers", sheet.outliers);
  app.add_flag("--choose-model", sheet.choose_model);
  app.add_flag("--estimate-sigmas", sheet.estimate_sigmas);
  app.add_flag("--known-odometry", sheet.known_odometry);
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  return bench_main(
      count, arguments, kHelp, [&](CLI::App& app) { declare_options(app, options); },
      [&] {
        if (options.convergence > 0) return run_convergence(options);
        if (options.suite) return run_suite(options);
        run_cells(options);
        return 0;
      });
}
