// Runs a sweep, on one machine or in shards on many: pictures and detections once, every (task, method) once, in spite
// of interruptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/study/sweep/config.h"
#include "rigproof/study/sweep/rows.h"

namespace rigproof {

/// What was done and what was taken from the cache, by name: "images rendered", "images from clean renders",
/// "image sets from cache", "corners detected", "corners from cache", "planes fitted", "planes from cache",
/// "clouds searched", "clouds from cache", "chessboards searched", "chessboards from cache", "board poses found",
/// "board poses from cache", "images matched", "matches from cache", "motions found", "motions from cache",
/// "observations made", "answers solved", "answers from cache", "answers already there".
using SweepCounters = std::map<std::string, std::uint64_t>;

struct SweepProgress {
  std::size_t images_done = 0, images = 0;    ///< of the pictures that this start needs
  std::size_t answers_done = 0, answers = 0;  ///< (task, method) pairs of the whole sweep
};

struct SweepOptions {
  std::filesystem::path folder;
  std::filesystem::path cache;    ///< empty = cache/ in the folder
  double cache_limit_gb = 0.0;    ///< pictures that were not used for the longest time are deleted; 0 = no limit
  int jobs = 0;                   ///< processes, 0 = one a core
  int device = -2;                ///< as RenderOptions::device
  std::vector<std::string> add;   ///< methods beside those of the configuration; kept in the folder
  std::vector<std::string> redo;  ///< methods whose finished answers are forgotten
  std::function<void(const SweepProgress&)> progress;  ///< told several times a second
  /// Asked several times a second, in forked processes, too; false stops: what is finished is kept.
  std::function<bool()> keep_going;
};

/// What the tables of a folder say.
struct SweepTables {
  SweepSummary summary;
  std::vector<std::string> missing;  ///< answers: "lambda 0, seed 3, task 0123456789abcdef: ml"
  std::vector<SweepMachineCount> machines;
};

struct SweepReport {
  bool complete = false;  ///< false: interrupted
  std::size_t answers = 0;
  SweepCounters counters;  ///< of this start
  double seconds = 0.0;
  SweepTables tables;  ///< of the whole folder; none of a shard
};

/// Does what is not done yet, then writes rows, times, counters and summary of everything. The rows are byte-identical
/// at any number of jobs. Throws Error with ExitCode::kTryAgain if another process works in the folder, and Error for
/// failures of the machine (no driver, a full disk), which are no answer of a method.
SweepReport run_sweep(const SweepConfig& config, const SweepOptions& options);

/// Some of the tasks of a planned sweep: index of 0 .. count - 1.
struct SweepShard {
  std::size_t index = 0, count = 1;
};

/// Writes what run_shard() works from. Returns the number of distinct tasks. Throws Error as run_sweep() does.
std::size_t plan_folder(const SweepConfig& config, const SweepOptions& options);

/// Does what is not done yet of a shard; of the options, methods are the plan's. Any number of processes on any
/// machines may do so at once, those of one shard, too. Throws Error where this program or the files that the sweep
/// names are others than those that planned, and with ExitCode::kTryAgain where the folder is not there (yet) or room
/// on its disk is gone.
SweepReport run_shard(const SweepOptions& options, const SweepShard& shard);

/// What a start would do.
struct SweepForecast {
  std::size_t points = 0, tasks = 0, answers = 0;
  std::size_t answers_there = 0;       ///< finished in the folder or in the cache
  std::size_t picture_sets = 0;        ///< that the tasks need
  std::size_t picture_sets_there = 0;  ///< whose pictures or detections the cache has
  std::size_t images_to_render = 0;    ///< about
  double megabytes = 0.0;              ///< about
  double minutes = 0.0;                ///< about
  /// Of programs from outside that have no answer here yet: taken for a second each.
  std::size_t answers_not_timed = 0;
  std::vector<std::string> task_lines;  ///< one a task: "lambda 0, seed 3: 2 of 6 answers"
  std::vector<std::string> cannot_run;  ///< methods that can answer no task, and why
};
SweepForecast forecast_sweep(const SweepConfig& config, const SweepOptions& options);

/// Progress of a sweep.
struct SweepState {
  std::string name;
  std::size_t tasks = 0, answers = 0, answers_there = 0;
  bool running = false;  ///< some process works in the folder
  std::vector<FailureCount> failures;
  std::vector<SweepMachineCount> machines;
  SweepCounters counters;  ///< of all starts on one machine
};
/// Throws Error, with ExitCode::kTryAgain if the folder is not there (yet).
SweepState sweep_state(const std::filesystem::path& folder);
/// The same of a folder that was there before: nothing while it is gone, as a share that is mounted again.
std::optional<SweepState> sweep_state_unless_gone(const std::filesystem::path& folder);

/// The file that describes a sweep: the argument itself, or what a sweep's folder holds. Throws Error.
std::filesystem::path sweep_config_file(const std::filesystem::path& file_or_folder);

/// Writes rows.csv, rows.jsonl, times.csv and the summary's files from the answers in the folder.
SweepTables gather_sweep(const std::filesystem::path& folder);

}  // namespace rigproof
