// What a start of a sweep finds finished, and what remains.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "answer_store.h"
#include "cache.h"
#include "folder.h"
#include "methods.h"
#include "rigproof/study/sweep/sweep.h"

namespace rigproof {

/// What a start works with. Nothing in it changes while it runs.
struct SweepStart {
  const SweepConfig& config;
  const SweepOptions& options;
  SweepFolder folder;
  SweepCache cache;
  std::vector<std::string> added;  ///< methods beside the configuration's
  std::vector<SweepMethod> methods;
  SweepPlan plan;
  std::vector<WorkItem> order;      ///< distinct tasks of the plan
  std::size_t first = 0, last = 0;  ///< places in it that this start does: [first, last)

  /// Throws Error with ExitCode::kTryAgain if the folder is gone: unmounted, moved or deleted.
  void require_folder() const;
  /// Takes the order from the plan, and the shard's part of it.
  void take_shard(const SweepShard& shard);
  bool keeps_going() const { return !options.keep_going || options.keep_going(); }
  std::size_t processes() const;
};

/// Without its plan. Throws Error for what is wrong with the methods.
SweepStart start_of(const SweepConfig& config, const SweepOptions& options);
/// Plans all tasks.
void plan_all(SweepStart* start);

/// What is left of one task; tasks of the same key are one.
struct PendingTask {
  const SweepTask* task = nullptr;
  std::size_t place = 0;    ///< in the order of work
  std::size_t repeats = 1;  ///< tasks of its key
  std::vector<const SweepMethod*> methods;
  std::optional<std::size_t> pictures;   ///< index in Stock::pictures
  const SweepMethod* current = nullptr;  ///< that its process is at
  int starts = 0;

  bool reads_images() const;
};

struct PendingPictures {
  PictureSet set;
  bool with_images = false;
  std::size_t images = 0, images_done = 0;
  enum class State { kWaiting, kRunning, kReady } state = State::kWaiting;
};

struct Stock {
  std::vector<PendingTask> tasks;
  std::vector<PendingPictures> pictures;  ///< that the pending tasks need
  std::size_t answers = 0, answers_done = 0;
  SweepCounters counters;
};

/// Finds what is finished, in the folder or in the cache. Answers of the cache are copied into the folder unless this
/// is only a look.
Stock take_stock(const SweepStart& start, bool only_look);

/// What the answer of a method is written to: the folder, and the cache for a method of our own. Throws Error with
/// ExitCode::kTryAgain where the folder is gone, rather than make another one at its place.
void keep_answer(const SweepStart& start, const SweepTask& task, const SweepMethod& method, SweepAnswer answer);

}  // namespace rigproof
