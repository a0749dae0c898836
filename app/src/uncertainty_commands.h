// `rigproof suggest` and `rigproof moved`: arguments, what each does, and how the command line is read into them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "commands.h"

namespace CLI {
class App;
}

namespace rigproof {

struct SuggestArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::string method = "ml";     ///< or ml:KEY=VALUE,.. or ml:FILE.yaml
  std::filesystem::path output;  ///< a configuration for `generate`; empty = none is written
  int stops = 3;
  std::string criterion = "worst";  ///< worst, D or E
  std::vector<double> area_m;       ///< x_min x_max y_min y_max; empty = near where the robot was
  double reach_m = 1.0;
  double clearance_m = 1.0;
  double min_turn_deg = 3.0;
  int min_cameras = 1;
  int candidates = 300;
  std::uint64_t seed = 0;
};
int suggest_command(const SuggestArguments& arguments);

struct MovedArguments {
  CommonArguments common;
  std::filesystem::path input;
  std::filesystem::path previous;  ///< a result file
  double significance_percent = 0.1;
  double smallest_cm = 2.0;
  double smallest_deg = 0.5;
};
int moved_command(const MovedArguments& arguments);

/// Adds both commands; parsing one of them sets the action.
void add_uncertainty_commands(CLI::App& app, std::function<int()>& action);

}  // namespace rigproof
