// What the command line offers, as its parser has it: help, completion and the manual say the same.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace rigproof {

struct OptionFacts {
  std::vector<std::string> names;  ///< "-o", "--output"; one without dashes where it is known by its place
  std::string description;
  std::string value;                 ///< what is written behind it: "TEXT"; empty: nothing
  std::vector<std::string> choices;  ///< of the value; empty: anything

  bool is_positional() const { return names.front().front() != '-'; }
};

struct CommandFacts {
  std::vector<std::string> path;  ///< {"sweep", "start"}; empty: the program itself
  std::string description;
  std::string group;   ///< under which help lists it
  std::string footer;  ///< what help says last
  std::vector<OptionFacts> options;
  std::vector<CommandFacts> commands;

  std::string name() const { return path.empty() ? "rigproof" : path.back(); }
};

CommandFacts facts_of(const CLI::App& app);

/// Throws Error for options and commands among the arguments that there are not, with the nearest of those that there
/// are.
/// @param arguments without the program's name
void check_names(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace rigproof
