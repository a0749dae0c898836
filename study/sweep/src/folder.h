// What lies in a sweep's folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "answer.h"
#include "methods.h"
#include "rigproof/study/sweep/sweep.h"

namespace rigproof {

struct SweepFolder {
  std::filesystem::path root;

  std::filesystem::path config_file() const { return root / "sweep.yaml"; }
  std::filesystem::path plan_file() const { return root / "plan.json"; }
  std::filesystem::path counters_file() const { return root / "counters.json"; }
  std::filesystem::path tasks() const { return root / "tasks"; }
  std::filesystem::path packs() const { return root / "packs"; }
  std::filesystem::path answer_file(const std::string& task, const std::string& method) const {
    return tasks() / task / (method + ".json");
  }
  std::filesystem::path logs(const std::string& task) const { return root / "logs" / task; }
};

/// plan.json: what the folder's tables are made of.
struct SweepPlan {
  SweepRows table;                 ///< without rows
  std::vector<std::string> added;  ///< methods beside the configuration's, as on the command line
  /// SweepMethod::hash, one a method of the table; empty in the plan of an older program
  std::vector<std::string> hashes;
};

SweepPlan sweep_plan_of(const SweepConfig& config, std::vector<SweepTask> tasks,
                        const std::vector<SweepMethod>& methods, std::vector<std::string> added);
void save_folder_plan(const SweepFolder& folder, const SweepPlan& plan);
/// Throws Error if the folder holds no sweep, with ExitCode::kTryAgain if it is not there (yet).
SweepPlan load_folder_plan(const SweepFolder& folder);

/// A finished answer in a file of its own; nothing if there is none, a damaged one, or that of another program.
std::optional<SweepAnswer> load_answer(const SweepFolder& folder, const SweepPlan& plan, const std::string& task,
                                       std::size_t method);

void save_counters(const SweepFolder& folder, const SweepCounters& this_start, const SweepCounters& all_starts);
/// Of all starts; empty where there is no such file.
SweepCounters load_counters(const SweepFolder& folder);

}  // namespace rigproof
