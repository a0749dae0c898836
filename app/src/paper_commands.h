// `rigproof paper`: arguments, what it does, and how the command line is read into them.
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

struct PaperArguments {
  CommonArguments common;
  std::string experiment;        ///< empty = list them
  std::filesystem::path config;  ///< a sweep in place of the shipped one; empty = none
  std::filesystem::path output;  ///< empty = paper/
  std::filesystem::path cache;   ///< empty = cache/ in the output
  bool dry_run = false;
  std::vector<std::string> set;
  int device = -2;
};
int paper_command(const PaperArguments& arguments);

/// Adds the command; parsing it sets the action.
void add_paper_command(CLI::App& app, std::function<int()>& action);

}  // namespace rigproof
