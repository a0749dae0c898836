// The command line of `sweep`.
#include "command_line.h"
#include "number_in.h"

namespace rigproof {
namespace {

void add_start(CLI::App* sweep, Action& action) {
  const auto [command, arguments] =
      add_command(*sweep, action, "start", "Start a sweep or go on with it, then print its summary",
                  "rigproof sweep start odometry.yaml -j 2 --add theirs.yaml", sweep_start_command,
                  "Interrupted or killed, the same command goes on where it was. Exit codes: 0 done, 2 bad input or "
                  "environment,\n75 interrupted, or another process works in the folder.\n");
  command
      ->add_option("CONFIG", arguments.config,
                   "File that describes the sweep (docs/guides/sweeps.md), or the folder of a sweep to go on with")
      ->required();
  command->add_option("-o,--output", arguments.output, "Folder of the results; default sweeps/<name>");
  add_cache(command, arguments.cache, "Folder of pictures, detections and solutions; default cache/ among the results");
  command
      ->add_option("--cache-limit-gb", arguments.cache_limit_gb,
                   "Keep the cache below this size by deleting the least recently used pictures; 0 = keep all")
      ->check(number_in(0.0, 1e6))
      ->capture_default_str();
  add_overrides(command, arguments.set,
                "Override a field of CONFIG, e.g. --set run.poses=20 --set seeds=2; may be repeated. The folder "
                "keeps what was set");
  command->add_flag("--dry-run", arguments.dry_run, "Only print the tasks and about how long they take");
  command->add_option("--add", arguments.add,
                      "Add a method to those of the configuration: a name, or external:FILE.yaml; may be repeated");
  command->add_option("--redo", arguments.redo, "Forget the finished answers of this method; may be repeated");
  add_jobs(command, arguments.common, "Processes; 0 = one for each core");
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_folder_command(CLI::App* sweep, const std::string& name, const std::string& description,
                        int (*run)(const SweepFolderArguments&), Action& action) {
  const auto [command, arguments] =
      add_command(*sweep, action, name, description, "rigproof sweep " + name + " sweeps/odometry", run);
  command->add_option("FOLDER", arguments.folder, "Folder of a sweep, finished or not")->required();
  add_common(command, arguments.common);
}

}  // namespace

void add_sweep_command(CLI::App& app, Action& action) {
  CLI::App* sweep = app.add_subcommand("sweep", "Vary a configuration, calibrate with every method, compare");
  sweep->require_subcommand(1);
  sweep->footer("Example:\n  rigproof sweep start odometry.yaml -j 2");
  add_start(sweep, action);
  add_folder_command(sweep, "status", "How far a sweep is, and what went wrong so far", sweep_status_command, action);
  add_folder_command(sweep, "summary", "Print the summary of what is done, and write its files anew",
                     sweep_summary_command, action);
}

}  // namespace rigproof
