// What the command lines of several commands share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "commands.h"

namespace rigproof {

/// What parsing the command line decides to do; returns the exit code.
using Action = std::function<int()>;

/// Adds a command whose options are read into arguments of its own. Parsing it makes `run` of them the action.
/// @param note stands before the example in its help
template <typename Arguments>
std::pair<CLI::App*, Arguments&> add_command(CLI::App& parent, Action& action, const std::string& name,
                                             const std::string& description, const std::string& example,
                                             int (*run)(const Arguments&), const std::string& note = "") {
  CLI::App* command = parent.add_subcommand(name, description);
  command->footer(note + "Example:\n  " + example);
  const auto arguments = std::make_shared<Arguments>();
  command->callback([arguments, run, &action] { action = [arguments, run] { return run(*arguments); }; });
  return {command, *arguments};
}

inline void add_common(CLI::App* command, CommonArguments& common) {
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but errors");
  command->add_flag("--json", common.json, "Print JSON for machines instead of text");
}

inline void add_jobs(CLI::App* command, CommonArguments& common,
                     const std::string& what = "Processes or threads; 0 = one for each core") {
  command->add_option("-j,--jobs", common.jobs, what)->check(CLI::Range(0, 1024))->capture_default_str();
}

inline void add_device(CLI::App* command, int& device) {
  command
      ->add_option("--device", device,
                   "EGL device to render on, as `rigproof doctor` numbers them; -1 = Mesa in software, -2 = best")
      ->check(CLI::Range(-2, 1024))
      ->capture_default_str();
}

inline void add_cache(CLI::App* command, std::filesystem::path& cache, const std::string& what) {
  command->add_option("--cache", cache, what)->envname("RIGPROOF_CACHE");
}

inline void add_overrides(CLI::App* command, std::vector<std::string>& set, const std::string& what) {
  command->add_option("--set", set, what)->type_name("FIELD=VALUE");
}

/// Command lines that have files of their own. Parsing a command sets the action.
void add_bench_command(CLI::App& app, Action& action);
void add_init_command(CLI::App& app, Action& action);
void add_record_check_command(CLI::App& app, Action& action);
void add_sweep_command(CLI::App& app, Action& action);
void add_paper_command(CLI::App& app, Action& action);
void add_uncertainty_commands(CLI::App& app, Action& action);

}  // namespace rigproof
