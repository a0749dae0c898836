// `rigproof sweep`: arguments, what each part does, and how the command line is read into them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "commands.h"

namespace CLI {
class App;
}

namespace rigproof {

struct SweepStartArguments {
  CommonArguments common;
  std::filesystem::path config;  ///< a sweep's file, or its folder
  std::filesystem::path output;  ///< empty = sweeps/<name>, or the folder that was given
  std::filesystem::path cache;
  double cache_limit_gb = 0.0;
  int device = -2;
  bool dry_run = false;
  std::vector<std::string> add;
  std::vector<std::string> redo;
  std::vector<std::string> set;
};
int sweep_start_command(const SweepStartArguments& arguments);

struct SweepFolderArguments {
  CommonArguments common;
  std::filesystem::path folder;
};
int sweep_status_command(const SweepFolderArguments& arguments);
int sweep_summary_command(const SweepFolderArguments& arguments);

/// Adds `sweep` with its parts; parsing one of them sets the action.
void add_sweep_command(CLI::App& app, std::function<int()>& action);

}  // namespace rigproof
