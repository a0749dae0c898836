// The command line of `sweep`.
#include <CLI/CLI.hpp>
#include <memory>

#include "number_in.h"
#include "sweep_commands.h"

namespace rigproof {
namespace {

void add_common_options(CLI::App* command, CommonArguments& common) {
  command->add_flag("-q,--quiet", common.quiet, "Print nothing but errors");
  command->add_flag("--json", common.json, "Print JSON for machines instead of text");
}

void add_start(CLI::App* sweep, std::function<int()>& action) {
  CLI::App* command = sweep->add_subcommand("start", "Do what is not done yet of a sweep, then print its summary");
  command->footer(
      "Interrupted or killed, the same command goes on where it was. Exit codes: 0 done, 2 bad input or environment,\n"
      "75 interrupted, or another process works in the folder.\n"
      "Example:\n  rigproof sweep start odometry.yaml -j 2 --add theirs.yaml");
  auto arguments = std::make_shared<SweepStartArguments>();
  command
      ->add_option("CONFIG", arguments->config, "A sweep's file (docs/sweeps.md), or the folder of one to go on with")
      ->required();
  command->add_option("-o,--output", arguments->output, "Folder of the results; default sweeps/<name>");
  command
      ->add_option("--cache", arguments->cache,
                   "Folder of pictures, detections and solutions; default cache/ among the results")
      ->envname("RIGPROOF_CACHE");
  command
      ->add_option("--cache-limit-gb", arguments->cache_limit_gb,
                   "Delete pictures that were not used for the longest time beyond this size; 0 = keep all")
      ->check(number_in(0.0, 1e6))
      ->capture_default_str();
  command
      ->add_option("--set", arguments->set,
                   "Override a field of CONFIG, e.g. --set run.poses=20 --set seeds=2; may be repeated. The folder "
                   "keeps what was set")
      ->type_name("FIELD=VALUE");
  command->add_flag("--dry-run", arguments->dry_run, "Only print the tasks and about how long they take");
  command->add_option("--add", arguments->add,
                      "Another method beside the configuration's, by name or external description; may be repeated");
  command->add_option("--redo", arguments->redo, "Forget the finished answers of this method; may be repeated");
  command->add_option("-j,--jobs", arguments->common.jobs, "Processes; 0 = one a core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command
      ->add_option("--device", arguments->device,
                   "EGL device to render on, as `rigproof doctor` numbers them; -1 = Mesa in software, -2 = best")
      ->check(CLI::Range(-2, 1024))
      ->capture_default_str();
  add_common_options(command, arguments->common);
  command->callback([arguments, &action] { action = [arguments] { return sweep_start_command(*arguments); }; });
}

void add_folder_command(CLI::App* sweep, const std::string& name, const std::string& description,
                        int (*run)(const SweepFolderArguments&), std::function<int()>& action) {
  CLI::App* command = sweep->add_subcommand(name, description);
  command->footer("Example:\n  rigproof sweep " + name + " sweeps/odometry");
  auto arguments = std::make_shared<SweepFolderArguments>();
  command->add_option("FOLDER", arguments->folder, "Folder of a sweep, finished or not")->required();
  add_common_options(command, arguments->common);
  command->callback([arguments, run, &action] { action = [arguments, run] { return run(*arguments); }; });
}

}  // namespace

void add_sweep_command(CLI::App& app, std::function<int()>& action) {
  CLI::App* sweep = app.add_subcommand("sweep", "Vary a configuration, calibrate with every method, compare");
  sweep->require_subcommand(1);
  sweep->footer("Example:\n  rigproof sweep start odometry.yaml -j 2");
  add_start(sweep, action);
  add_folder_command(sweep, "status", "How far a sweep is, and what went wrong so far", sweep_status_command, action);
  add_folder_command(sweep, "summary", "Print the summary of what is done, and write its files anew",
                     sweep_summary_command, action);
}

}  // namespace rigproof
