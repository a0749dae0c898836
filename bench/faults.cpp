// What calibration says of recordings that are broken in files, as people break theirs: the table of
// docs/measurements/refusals.md. Exit code 1 where a fault leaves a value wrong by more than five sigmas, and nothing
// says so.
//   bench_faults [--data FOLDER] [--faults REGEX] [--rigs husky,cart,single] [--seeds 5] [--healthy 0] [--jobs N]
//                [--full] [--pictures realistic] [--csv FILE] [--list]
// Drives are rendered into FOLDER, where they stay for the next time; without one into a temporary folder.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "bench_main.h"
#include "faults/recording_faults.h"
#include "faults_data.h"
#include "faults_verdict.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/random.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/scratch_folder.h"

namespace {

using namespace rigproof;
using bench::Outcome;
using faults::RecordingFault;
namespace fs = std::filesystem;

struct Options {
  std::string data, csv, faults = ".*", rigs = joined(bench::fault_rigs(), ",");
  int seeds = 5, healthy = 0, jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool list = false;
  bench::DriveKind kind;
};

std::vector<std::string> listed(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

struct Drive {
  std::string rig;
  std::uint64_t seed = 0;
  fs::path run;
  Recording recording;
  Truth truth;
};

/// A fault in a drive; without a fault the drive as it is, or with some of its stops.
struct Cell {
  const RecordingFault* fault = nullptr;
  const Drive* drive = nullptr;
  int subset = 0;  ///< of a healthy drive: 0 = all of it
  std::optional<bench::Verdict> verdict;

  std::string name() const { return fault != nullptr ? fault->name : "healthy"; }
  std::string part() const { return fault != nullptr ? fault->part : "healthy"; }
  bool is_silent() const {
    return verdict->outcome == Outcome::kSilent && (fault == nullptr || fault->cannot_show.empty());
  }
};

std::regex expression_of(const std::string& text) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& error) {
    throw Error("--faults: " + text + ": " + error.what());
  }
}

std::vector<RecordingFault> faults_wanted(const Options& options) {
  std::vector<RecordingFault> all = faults::recording_faults();
  const std::vector<RecordingFault> pairs = faults::recording_fault_pairs();
  all.insert(all.end(), pairs.begin(), pairs.end());
  const std::regex wanted = expression_of(options.faults);
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const RecordingFault& fault) {
                             return !std::regex_search(fault.name, wanted) && !std::regex_search(fault.part, wanted);
                           }),
            all.end());
  return all;
}

std::vector<Drive> drives_of(const Options& options, const std::vector<RecordingFault>& faults, const fs::path& data) {
  std::vector<Drive> drives;
  std::set<std::string> variants;
  for (const RecordingFault& fault : faults) variants.insert(fault.variants.begin(), fault.variants.end());
  for (const std::string& rig : listed(options.rigs))
    for (int i = 0; i < options.seeds; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      const fs::path run = bench::drive_of(data, rig, seed, options.kind);
      bench::add_variants(run, rig, seed, options.kind, variants);
      drives.push_back({rig, seed, run, load_recording(run / "recording"), load_truth(RunFolder{run}.truth_file())});
      std::fprintf(stderr, "\r%s-%d  ", rig.c_str(), i);
    }
  return drives;
}

std::vector<Cell> cells_of(const Options& options, const std::vector<RecordingFault>& faults,
                           const std::vector<Drive>& drives) {
  std::vector<Cell> cells;
  for (const RecordingFault& fault : faults)
    for (const Drive& drive : drives)
      if (!fault.fits || fault.fits(drive.recording.rig)) cells.push_back({&fault, &drive, 0, {}});
  for (int i = 0; i < options.healthy; ++i) {
    const int count = static_cast<int>(drives.size());
    cells.push_back({nullptr, &drives[static_cast<std::size_t>(i % count)], i / count, {}});
  }
  return cells;
}

// Another drive: without a quarter of the stops, which the number of the subset draws.
void leave_stops_out(int subset, faults::FaultyRecording* recording) {
  const auto is_out = [&](double stamp_s) {
    return RandomStream(static_cast<std::uint64_t>(subset), "left out", std::llround(1e3 * stamp_s)).uniform() < 0.25;
  };
  for (std::size_t k = 0; k < recording->cameras(); ++k)
    recording->edit_frames(k, [&](std::vector<CameraFrame>* frames) {
      frames->erase(std::remove_if(frames->begin(), frames->end(),
                                   [&](const CameraFrame& frame) { return is_out(frame.stamp_s); }),
                    frames->end());
    });
}

bench::Verdict run(const Cell& cell, const fs::path& folder, bench::SharedFindings* findings) {
  faults::FaultyRecording recording(cell.drive->run, folder, cell.drive->seed);
  if (cell.fault != nullptr) cell.fault->apply(&recording);
  if (cell.subset > 0) leave_stops_out(cell.subset, &recording);
  bench::Naming right = {{}, recording.broken()};
  if (cell.fault != nullptr) right.codes = cell.fault->codes;
  if (cell.fault != nullptr && cell.drive->recording.rig.cameras.size() == 1)
    right.codes.insert(right.codes.end(), cell.fault->codes_if_alone.begin(), cell.fault->codes_if_alone.end());
  return bench::judge_recording(folder, cell.drive->truth, right, findings);
}

std::string csv_of(const std::vector<Cell>& cells) {
  std::string text = "fault,part,rig,seed,subset,outcome,status,first,worst_z,worst,sentence\n";
  const auto quoted = [](std::string words) {
    std::replace(words.begin(), words.end(), '"', '\'');
    std::replace(words.begin(), words.end(), '\n', ' ');
    return "\"" + words + "\"";
  };
  for (const Cell& cell : cells) {
    if (!cell.verdict) continue;
    const bench::Verdict& verdict = *cell.verdict;
    text += joined({quoted(cell.name()), cell.part(), cell.drive->rig, std::to_string(cell.drive->seed),
                    std::to_string(cell.subset), bench::outcome_name(verdict.outcome), verdict.status, verdict.first,
                    number_text(verdict.worst_z), quoted(verdict.worst), quoted(verdict.sentence)},
                   ",") +
            "\n";
  }
  return text;
}

// Each in a folder of its own beside the drives, where files can be shared; several programs may work with the same.
// What is done so far stands in the CSV, for who stops it early.
void run_all(const Options& options, const fs::path& data, std::vector<Cell>* cells) {
  bench::SharedFindings findings;
  std::atomic<std::size_t> next{0};
  int done = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&](int worker) {
    const fs::path folder = data / ("cell-" + std::to_string(::getpid()) + "-" + std::to_string(worker));
    for (std::size_t i; (i = next++) < cells->size();) try {
        fs::remove_all(folder);
        const bench::Verdict verdict = run((*cells)[i], folder, &findings);
        const std::lock_guard<std::mutex> guard(mutex);
        (*cells)[i].verdict = verdict;
        if (!options.csv.empty() && ++done % 100 == 0) write_file_atomically(options.csv, csv_of(*cells));
        if (i % 20 == 0) std::fprintf(stderr, "\r%zu of %zu  ", i, cells->size());
      } catch (...) {
        const std::lock_guard<std::mutex> guard(mutex);
        failure = std::current_exception();
        next = cells->size();
      }
    fs::remove_all(folder);
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < std::max(1, options.jobs); ++i) workers.emplace_back(work, i);
  for (std::thread& worker : workers) worker.join();
  std::fprintf(stderr, "\r");
  if (failure) std::rethrow_exception(failure);
}

struct Row {
  std::array<int, bench::kOutcomes> outcomes{};
  double worst_z = 0.0;
  std::map<std::string, int> said;

  int runs() const { return std::accumulate(outcomes.begin(), outcomes.end(), 0); }
  int count(Outcome outcome) const { return outcomes[static_cast<std::size_t>(outcome)]; }
  void add(const bench::Verdict& verdict) {
    ++outcomes[static_cast<std::size_t>(verdict.outcome)];
    worst_z = std::max(worst_z, verdict.worst_z);
    if (!verdict.first.empty()) ++said[verdict.first];
  }
  std::string mostly() const {
    const auto most =
        std::max_element(said.begin(), said.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == said.end() ? "" : most->first;
  }
};

void print_row(const std::string& name, const Row& row) {
  std::printf("| %s | %d |", name.c_str(), row.runs());
  for (const int count : row.outcomes) std::printf(count > 0 ? " %d |" : " |", count);
  std::printf(" %s | %s |\n", short_text(row.worst_z, 3).c_str(), row.mostly().c_str());
}

void print_head(const char* first) {
  std::printf("\n| %s | runs |", first);
  for (std::size_t i = 0; i < bench::kOutcomes; ++i) std::printf(" %s |", bench::outcome_name(static_cast<Outcome>(i)));
  std::printf(" largest z | says mostly |\n|---|---|---|---|---|---|---|---|---|\n");
}

// In the order of the cells.
void print_table(const char* first, const std::vector<Cell>& cells,
                 const std::function<std::string(const Cell&)>& name_of) {
  std::vector<std::string> names;
  std::map<std::string, Row> rows;
  for (const Cell& cell : cells) {
    const std::string name = name_of(cell);
    if (rows.count(name) == 0) names.push_back(name);
    rows[name].add(*cell.verdict);
  }
  print_head(first);
  for (const std::string& name : names) print_row(name, rows[name]);
}

void print_what_cannot_show(const std::vector<RecordingFault>& faults) {
  for (const RecordingFault& fault : faults)
    if (!fault.cannot_show.empty())
      std::printf("\nNo data show %s: %s\n", fault.name.c_str(), fault.cannot_show.c_str());
}

void print_share_named(const std::vector<Cell>& cells) {
  Row all;
  for (const Cell& cell : cells)
    if (cell.fault != nullptr) all.add(*cell.verdict);
  const int refused = all.count(Outcome::kNamed) + all.count(Outcome::kMisnamed);
  if (refused > 0)
    std::printf("\n%d of %d refusals name the cause first: %.1f %%\n", all.count(Outcome::kNamed), refused,
                100.0 * all.count(Outcome::kNamed) / refused);
}

void print_healthy(const std::vector<Cell>& cells) {
  int runs = 0, alarms = 0, unsolved = 0, beyond = 0;
  for (const Cell& cell : cells) {
    if (cell.fault != nullptr) continue;
    ++runs;
    alarms += cell.verdict->is_alarm;
    unsolved += cell.verdict->status != "solved";
    beyond += cell.is_silent();
  }
  if (runs > 0)
    std::printf("\n%d healthy runs: %d false alarms, %d not solved whole, %d beyond five sigmas\n", runs, alarms,
                unsolved, beyond);
}

int list(const std::vector<RecordingFault>& faults) {
  for (const RecordingFault& fault : faults) std::printf("%-10s %s\n", fault.part.c_str(), fault.name.c_str());
  std::printf("%zu faults\n", faults.size());
  return 0;
}

int measure(const Options& options, const std::vector<RecordingFault>& faults) {
  std::optional<ScratchFolder> scratch;
  if (options.data.empty()) scratch.emplace("bench-faults");
  const fs::path data = scratch ? scratch->path() : fs::path(options.data);
  const std::vector<Drive> drives = drives_of(options, faults, data);
  std::vector<Cell> cells = cells_of(options, faults, drives);
  run_all(options, data, &cells);
  print_table("fault", cells, [](const Cell& cell) { return cell.name(); });
  print_table("part", cells, [](const Cell& cell) { return cell.part(); });
  print_what_cannot_show(faults);
  print_share_named(cells);
  print_healthy(cells);
  if (!options.csv.empty()) write_file_atomically(options.csv, csv_of(cells));
  const bool silent = std::any_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.is_silent(); });
  return static_cast<int>(silent ? ExitCode::kGateFailed : ExitCode::kGood);
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  bool full = false;
  const auto declare = [&](CLI::App& app) {
    app.add_option("--data", options.data, "where drives are rendered and stay; without it a temporary folder");
    app.add_option("--faults", options.faults, "regular expression of parts or faults");
    app.add_option("--rigs", options.rigs, "husky,cart,single");
    app.add_option("--csv", options.csv, "a line for each run");
    add_count(app, "--seeds", options.seeds);
    add_count(app, "--healthy", options.healthy);
    add_count(app, "--jobs", options.jobs);
    app.add_option("--pictures", options.kind.pictures,
                   "a run's configuration: plain, or realistic pictures and devices");
    app.add_flag("--full", full, "images of full size, 40 stops");
    app.add_flag("--list", options.list, "only names the faults");
  };
  return bench_main(count, arguments, "What calibration says of recordings that are broken in files", declare, [&] {
    if (full) options.kind = {"-full", 1.0, 40, options.kind.pictures};
    if (options.kind.pictures != bench::DriveKind().pictures) options.kind.name += "-" + options.kind.pictures;
    const std::vector<RecordingFault> faults = faults_wanted(options);
    return options.list ? list(faults) : measure(options, faults);
  });
}
