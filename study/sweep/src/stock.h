// What a start of a sweep finds finished, and what remains.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

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

  bool keeps_going() const { return !options.keep_going || options.keep_going(); }
  std::size_t processes() const;
};

/// Without its plan. Throws Error for what is wrong with the methods.
SweepStart start_of(const SweepConfig& config, const SweepOptions& options);

/// What is left of one task; tasks of the same key are one.
struct PendingTask {
  const SweepTask* task = nullptr;
  std::size_t repeats = 1;  ///< tasks of its key
  std::vector<const SweepMethod*> methods;
  std::optional<std::size_t> pictures;   ///< index in Stock::pictures
  const SweepMethod* current = nullptr;  ///< that its process is at
  int starts = 0;

  bool reads_images() const;
};

struct PendingPictures {
  const PictureSet* set = nullptr;
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

/// What the answer of a method is written to: the folder, and the cache for a method of our own.
void keep_answer(const SweepStart& start, const SweepTask& task, const SweepMethod& method, SweepAnswer answer);

}  // namespace rigproof
