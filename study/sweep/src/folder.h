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
  std::filesystem::path answer_file(const std::string& task, const std::string& method) const {
    return tasks() / task / (method + ".json");
  }
  std::filesystem::path logs(const std::string& task) const { return root / "logs" / task; }
};

/// plan.json: what the folder's tables are made of.
struct FolderPlan {
  SweepRows table;                 ///< without rows
  std::vector<std::string> added;  ///< methods beside the configuration's, as on the command line
};

SweepRows table_of(const SweepConfig& config, const SweepPlan& plan, const std::vector<SweepMethod>& methods);
void save_folder_plan(const SweepFolder& folder, const FolderPlan& plan);
/// Throws Error if the folder holds no sweep.
FolderPlan load_folder_plan(const SweepFolder& folder);

/// A finished answer; nothing if there is none, or a damaged one.
std::optional<SweepAnswer> load_answer(const SweepFolder& folder, const std::string& task, const std::string& method);

void save_counters(const SweepFolder& folder, const SweepCounters& this_start, const SweepCounters& all_starts);
/// Of all starts; empty where there is no such file.
SweepCounters load_counters(const SweepFolder& folder);

}  // namespace rigproof
