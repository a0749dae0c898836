// The command line of `sweep`.
#include "command_line.h"
#include "number_in.h"

namespace rigproof {
namespace {

constexpr const char* kConfigHelp =
    "File that describes the sweep (docs/guides/sweeps.md), or the folder of a sweep to go on with";
constexpr const char* kAddHelp =
    "Add a method to those of the configuration: a name, or external:FILE.yaml; may be repeated";
constexpr const char* kSetHelp =
    "Override a field of CONFIG, e.g. --set run.poses=20 --set seeds=2; may be repeated. The folder keeps what was set";
constexpr const char* kSweepCacheHelp =
    "Folder of pictures, detections and solutions; default cache/ among the results";

void add_start(CLI::App* sweep, Action& action) {
  const auto [command, arguments] =
      add_command(*sweep, action, "start", "Start a sweep or go on with it, then print its summary",
                  "rigproof sweep start odometry.yaml -j 2 --add theirs.yaml", sweep_start_command,
                  "Interrupted or killed, the same command goes on where it was. Exit codes: 0 done, 2 bad input or "
                  "environment,\n75 interrupted, or another process works in the folder.\n");
  command->add_option("CONFIG", arguments.config, kConfigHelp)->required()->type_name("SWEEP");
  command->add_option("-o,--output", arguments.output, "Folder of the results; default sweeps/<name>");
  add_cache(command, arguments.cache, kSweepCacheHelp);
  command
      ->add_option("--cache-limit-gb", arguments.cache_limit_gb,
                   "Keep the cache below this size by deleting the least recently used pictures; 0 = keep all")
      ->check(number_in(0.0, 1e6))
      ->capture_default_str();
  add_overrides(command, arguments.set, kSetHelp);
  command->add_flag("--dry-run", arguments.dry_run, "Only print the tasks and about how long they take");
  command->add_option("--add", arguments.add, kAddHelp)->type_name("METHOD");
  command->add_option("--redo", arguments.redo, "Forget the finished answers of this method; may be repeated")
      ->type_name("METHOD");
  add_jobs(command, arguments.common, "Processes; 0 = one for each core");
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_plan(CLI::App* sweep, Action& action) {
  const auto [command, arguments] =
      add_command(*sweep, action, "plan", "Plan a sweep that many processes or machines share",
                  "rigproof sweep plan odometry.yaml -o /shared/odometry", sweep_plan_command,
                  "`sweep run` does its shards, `sweep merge` makes the tables: docs/guides/cluster.md.\n");
  command->add_option("CONFIG", arguments.config, kConfigHelp)->required()->type_name("SWEEP");
  command->add_option("-o,--output", arguments.output, "Folder that all of them see; default sweeps/<name>");
  add_overrides(command, arguments.set, kSetHelp);
  command->add_option("--add", arguments.add, kAddHelp)->type_name("METHOD");
  add_common(command, arguments.common);
}

void add_run(CLI::App* sweep, Action& action) {
  const auto [command, arguments] = add_command(
      *sweep, action, "run", "Do a shard of a planned sweep", "rigproof sweep run /shared/odometry --shard 3/16 -j 2",
      sweep_run_command,
      "What is finished is not done again. May be killed, started again and started twice at any time. Exit codes: 0 "
      "done,\n2 bad input or environment, 75 interrupted, or the folder is not there, or its disk is full: try "
      "again.\n");
  command->add_option("FOLDER", arguments.folder, "Folder of a planned sweep")->required();
  command->add_option("--shard", arguments.shard, "INDEX/COUNT: this part of so many, counted from 0")
      ->capture_default_str();
  add_cache(command, arguments.cache, kSweepCacheHelp);
  add_jobs(command, arguments.common, "Processes; 0 = one for each core");
  add_device(command, arguments.device);
  add_common(command, arguments.common);
}

void add_slurm(CLI::App* sweep, Action& action) {
  constexpr double kMany = 1e6;
  const auto [command, arguments] =
      add_command(*sweep, action, "slurm", "Write the batch scripts of a planned sweep for Slurm, and submit them",
                  "rigproof sweep slurm /shared/odometry --array 200 --throttle 50 --sbatch=--time=4:00:00 --submit",
                  sweep_slurm_command);
  command->add_option("FOLDER", arguments.folder, "Folder of a planned sweep that all nodes see")->required();
  command->add_option("--array", arguments.array, "Array tasks, each a shard; 0 = one for every 100 tasks of the sweep")
      ->check(number_in(0.0, kMany))
      ->capture_default_str();
  command->add_option("--throttle", arguments.throttle, "Array tasks that run at once; 0 = no limit")
      ->check(number_in(0.0, kMany))
      ->capture_default_str();
  command->add_option("--cpus", arguments.cpus, "Cores of an array task")
      ->check(number_in(1.0, 1024.0))
      ->capture_default_str();
  command->add_option("--sbatch", arguments.options,
                      "An option of sbatch, such as --sbatch=--partition=long; may be repeated");
  add_cache(command, arguments.cache, kSweepCacheHelp);
  command->add_flag("--submit", arguments.submit, "Hand them to Slurm");
  add_common(command, arguments.common);
}

void add_folder_command(CLI::App* sweep, const std::string& name, const std::string& description,
                        int (*run)(const SweepFolderArguments&), Action& action, const std::string& note = "") {
  const auto [command, arguments] =
      add_command(*sweep, action, name, description, "rigproof sweep " + name + " sweeps/odometry", run, note);
  command->add_option("FOLDER", arguments.folder, "Folder of a sweep, finished or not")->required();
  if (name == "status") command->add_flag("--follow", arguments.follow, "Tell it every few seconds until all is done");
  add_common(command, arguments.common);
}

}  // namespace

void add_sweep_command(CLI::App& app, Action& action) {
  CLI::App* sweep = app.add_subcommand("sweep", "Vary a configuration, calibrate with every method, compare");
  sweep->require_subcommand(1);
  sweep->footer("Example:\n  rigproof sweep start odometry.yaml -j 2");
  add_start(sweep, action);
  add_plan(sweep, action);
  add_run(sweep, action);
  add_folder_command(sweep, "merge", "Make the tables of a planned sweep, and name what is missing",
                     sweep_merge_command, action,
                     "Exit codes: 0 complete, 1 answers are missing; the tables hold what is there.\n");
  add_slurm(sweep, action);
  add_folder_command(sweep, "status", "How far a sweep is, and what went wrong so far", sweep_status_command, action);
  add_folder_command(sweep, "summary", "Print the summary of what is done, and write its files anew",
                     sweep_summary_command, action);
}

}  // namespace rigproof
