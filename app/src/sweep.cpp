// `rigproof sweep`.
#include "rigproof/study/sweep/sweep.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "commands.h"
#include "json_text.h"
#include "rigproof/core/child_process.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/study/sweep/slurm.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownTasks = 20, kShownReason = 300;

fs::path file_of(const SweepStartArguments& arguments) {
  if (fs::is_directory(arguments.config)) return sweep_config_file(arguments.config);
  return find_data_file("config", arguments.config.string());
}

fs::path folder_of(const SweepStartArguments& arguments, const SweepConfig& config) {
  if (!arguments.output.empty()) return arguments.output;
  return fs::is_directory(arguments.config) ? arguments.config : fs::path("sweeps") / config.name;
}

SweepOptions options_of(const SweepStartArguments& arguments, const SweepConfig& config) {
  SweepOptions options;
  options.folder = folder_of(arguments, config);
  options.cache = arguments.cache;
  options.cache_limit_gb = arguments.cache_limit_gb;
  options.jobs = arguments.common.jobs;
  options.device = arguments.device;
  options.add = arguments.add;
  options.redo = arguments.redo;
  options.keep_going = [] { return !interrupted(); };
  return options;
}

int print_forecast(const SweepForecast& forecast, const SweepOptions& options, const CommonArguments& common) {
  if (common.json) {
    const nlohmann::json json = {{"folder", options.folder.string()},
                                 {"points", forecast.points},
                                 {"tasks", forecast.tasks},
                                 {"answers", forecast.answers},
                                 {"answers_there", forecast.answers_there},
                                 {"picture_sets", forecast.picture_sets},
                                 {"picture_sets_there", forecast.picture_sets_there},
                                 {"images_to_render", forecast.images_to_render},
                                 {"expected_mb", forecast.megabytes},
                                 {"expected_minutes", forecast.minutes},
                                 {"answers_not_timed", forecast.answers_not_timed},
                                 {"task_lines", forecast.task_lines},
                                 {"cannot_run", forecast.cannot_run}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  const Terminal terminal(common.quiet);
  for (std::size_t i = 0; i < forecast.task_lines.size() && i < kShownTasks; ++i)
    terminal.line(" " + forecast.task_lines[i]);
  if (forecast.task_lines.size() > kShownTasks)
    terminal.line(" and " + std::to_string(forecast.task_lines.size() - kShownTasks) + " more (--json lists all)");
  terminal.line(std::to_string(forecast.points) + " points, " + std::to_string(forecast.tasks) + " tasks, " +
                std::to_string(forecast.answers) + " answers, " + std::to_string(forecast.answers_there) +
                " of them there");
  if (forecast.picture_sets > 0)
    terminal.line(std::to_string(forecast.picture_sets) + " sets of pictures, " +
                  std::to_string(forecast.picture_sets_there) + " of them there; about " +
                  std::to_string(forecast.images_to_render) + " images to render, " +
                  megabytes(forecast.megabytes * 1e6));
  for (const std::string& line : forecast.cannot_run) terminal.line("cannot run: " + line);
  const std::string guessed = std::to_string(forecast.answers_not_timed) + " answers of programs from outside, which ";
  terminal.line("about " + duration(60.0 * forecast.minutes) +
                (forecast.answers_not_timed == 0 ? "" : ", with 1 s for each of " + guessed + "nobody has timed yet"));
  terminal.line("would write " + options.folder.string());
  return 0;
}

std::string counters_text(const SweepCounters& counters) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counters)
    if (count > 0) parts.push_back(std::to_string(count) + " " + name);
  return joined(parts);
}

template <typename Run>
SweepReport run_with_progress(SweepOptions options, const Terminal& terminal, const Run& run) {
  ProgressLine line(terminal, "sweep", "images and answers");
  options.progress = [&line](const SweepProgress& progress) {
    line.update(progress.images_done + progress.answers_done, progress.images + progress.answers);
  };
  const SweepReport report = run(options);
  if (!report.complete)
    throw Error("interrupted; the same command goes on with " + options.folder.string(), ExitCode::kTryAgain);
  return report;
}

SweepShard shard_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto index = parse_integer(text.substr(0, slash));
  const auto count = slash == std::string::npos ? std::nullopt : parse_integer(text.substr(slash + 1));
  if (!index || !count || *index < 0 || *index >= *count)
    throw Error("--shard " + for_message(text) + ": must be INDEX/COUNT with INDEX from 0 to COUNT - 1, such as 0/16");
  return {static_cast<std::size_t>(*index), static_cast<std::size_t>(*count)};
}

nlohmann::json machines_json(const std::vector<SweepMachineCount>& machines) {
  nlohmann::json list = nlohmann::json::array();
  for (const SweepMachineCount& entry : machines)
    list.push_back({{"host", entry.machine.host},
                    {"cpu", entry.machine.cpu},
                    {"gl_renderer", entry.machine.gl_renderer},
                    {"answers", entry.answers}});
  return list;
}

void print_machines(const std::vector<SweepMachineCount>& machines, const Terminal& terminal) {
  if (machines.size() > 1)
    for (const SweepMachineCount& entry : machines)
      terminal.line(" " + std::to_string(entry.answers) + " answers from " + entry.machine.host + ", " +
                    entry.machine.cpu + (entry.machine.gl_renderer.empty() ? "" : ", " + entry.machine.gl_renderer));
  if (has_mixed_renderers(machines))
    terminal.line(terminal.colored("MIXED GL DRIVERS", Color::kWarning) +
                  "  pictures differ from driver to driver; times.csv says which answers are whose");
}

void print_state(const SweepState& state, const Terminal& terminal) {
  terminal.line(state.name + "  " + std::to_string(state.answers_there) + "/" + std::to_string(state.answers) +
                " answers of " + std::to_string(state.tasks) + " tasks" + (state.running ? ", running" : ""));
  for (const FailureCount& failure : state.failures)
    terminal.line(" " + std::to_string(failure.tasks) + " x " + failure.method + " " +
                  sweep_status_name(failure.status) + ": " +
                  for_message(words::text_of(failure.reasons), kShownReason));
  print_machines(state.machines, terminal);
  if (!state.counters.empty()) terminal.line("all starts: " + counters_text(state.counters));
}

nlohmann::json state_json(const SweepState& state) {
  nlohmann::json failures = nlohmann::json::array();
  for (const FailureCount& failure : state.failures)
    failures.push_back({{"method", failure.method},
                        {"status", sweep_status_name(failure.status)},
                        {"code", code_of(failure.reasons)},
                        {"reason", words::text_of(failure.reasons)},
                        {"tasks", failure.tasks}});
  return {{"name", state.name},
          {"tasks", state.tasks},
          {"answers", state.answers},
          {"answers_there", state.answers_there},
          {"running", state.running},
          {"failures", failures},
          {"machines", machines_json(state.machines)},
          {"counters", state.counters}};
}

// "sweep      1200/10000 answers  12/s  about 12 min left".
std::string progress_text(const SweepState& state, std::size_t first, double seconds) {
  const auto there = static_cast<double>(state.answers_there), all = static_cast<double>(state.answers);
  const double rate = std::max(0.0, there - static_cast<double>(first)) / seconds;
  std::string line = state.name + "  " + std::to_string(state.answers_there) + "/" + std::to_string(state.answers) +
                     " answers  " + short_text(rate, 2) + "/s";
  return rate > 0.0 ? line + "  about " + duration((all - there) / rate) : line;
}

void pause_between_looks() {
  constexpr std::chrono::seconds kPause{5};
  for (auto waited = std::chrono::milliseconds(0); waited < kPause; waited += std::chrono::milliseconds(100)) {
    if (interrupted()) throw Error("interrupted; the sweep goes on", ExitCode::kTryAgain);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

void follow(SweepState state, const fs::path& folder, const Terminal& terminal) {
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t first = state.answers_there;
  bool gone = false;
  while (state.answers_there < state.answers) {
    pause_between_looks();
    const std::optional<SweepState> now = sweep_state_unless_gone(folder);
    if (!now && !gone) terminal.line(folder.string() + ": is gone; waiting until it is there again");
    gone = !now;
    if (gone) continue;
    state = *now;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    terminal.line(progress_text(state, first, seconds));
  }
}

// Returns what Slurm says.
std::string submit(const fs::path& script) {
  constexpr double kTimeLimit_s = 600.0;
  const fs::path file = fs::absolute(script), log = file.string() + ".log", errors = file.string() + ".err";
  const ProgramReport report = run_program(
      {{"bash", file.string()}, file.parent_path(), log, errors, kTimeLimit_s, [] { return !interrupted(); }});
  if (!report.failure.empty())
    throw Error(file.string() + ": " + report.failure + ": " +
                for_message(fs::exists(errors) ? read_text_file(errors) : "", kShownReason));
  return read_text_file(log);
}

// Returns the exit code: what is missing is told, never left out in silence.
int tell_missing(const SweepTables& tables, const fs::path& folder) {
  if (tables.missing.empty()) return 0;
  std::string text = folder.string() + ": " + std::to_string(tables.missing.size()) + " answers are missing";
  for (std::size_t i = 0; i < tables.missing.size() && i < kShownTasks; ++i) text += "\n " + tables.missing[i];
  if (tables.missing.size() > kShownTasks)
    text += "\n and " + std::to_string(tables.missing.size() - kShownTasks) + " more (--json lists all)";
  throw Error(text + "\n`rigproof sweep run " + folder.string() + "` makes what is missing", ExitCode::kGateFailed);
}

}  // namespace

int sweep_start_command(const SweepStartArguments& arguments) {
  const SweepConfig config = load_sweep_config(file_of(arguments), arguments.set);
  const SweepOptions options = options_of(arguments, config);
  const CommonArguments& common = arguments.common;
  if (arguments.dry_run) return print_forecast(forecast_sweep(config, options), options, common);
  const Terminal terminal(common.quiet || common.json);
  const SweepReport report = run_with_progress(
      options, terminal, [&config](const SweepOptions& with_progress) { return run_sweep(config, with_progress); });
  const SweepSummary& summary = report.tables.summary;
  if (common.json) {
    nlohmann::json json = nlohmann::json::parse(summary_as_json(summary));
    json["folder"] = options.folder.string();
    json["seconds"] = report.seconds;
    json["counters"] = report.counters;
    std::puts(json_text(json).c_str());
    return 0;
  }
  terminal.text(format_summary(summary));
  terminal.line("sweep      " + std::to_string(report.answers) + " answers  " + duration(report.seconds) + "  (" +
                counters_text(report.counters) + ")");
  terminal.line("tables     " + options.folder.string());
  return 0;
}

int sweep_plan_command(const SweepStartArguments& arguments) {
  const SweepConfig config = load_sweep_config(file_of(arguments), arguments.set);
  const SweepOptions options = options_of(arguments, config);
  const std::size_t tasks = plan_folder(config, options);
  if (arguments.common.json)
    std::puts(json_text({{"folder", options.folder.string()}, {"tasks", tasks}}).c_str());
  else
    Terminal(arguments.common.quiet).line("planned    " + std::to_string(tasks) + " tasks  " + options.folder.string());
  return 0;
}

int sweep_run_command(const SweepRunArguments& arguments) {
  const SweepShard shard = shard_of(arguments.shard);
  SweepOptions options;
  options.folder = arguments.folder;
  options.cache = arguments.cache;
  options.jobs = arguments.common.jobs;
  options.device = arguments.device;
  options.keep_going = [] { return !interrupted(); };
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const SweepReport report = run_with_progress(
      options, terminal, [&shard](const SweepOptions& with_progress) { return run_shard(with_progress, shard); });
  if (arguments.common.json)
    std::puts(json_text({{"folder", options.folder.string()},
                         {"shard", arguments.shard},
                         {"answers", report.answers},
                         {"seconds", report.seconds},
                         {"counters", report.counters}})
                  .c_str());
  terminal.line("shard      " + arguments.shard + "  " + std::to_string(report.answers) + " answers  " +
                duration(report.seconds) + "  (" + counters_text(report.counters) + ")");
  return 0;
}

int sweep_merge_command(const SweepFolderArguments& arguments) {
  const SweepTables tables = gather_sweep(arguments.folder);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  if (arguments.common.json) {
    nlohmann::json json = nlohmann::json::parse(summary_as_json(tables.summary));
    json["missing"] = tables.missing;
    json["machines"] = machines_json(tables.machines);
    std::puts(json_text(json).c_str());
  }
  terminal.text(format_summary(tables.summary));
  print_machines(tables.machines, terminal);
  terminal.line("tables     " + arguments.folder.string());
  return tell_missing(tables, arguments.folder);
}

int sweep_status_command(const SweepFolderArguments& arguments) {
  const SweepState state = sweep_state(arguments.folder);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  if (arguments.common.json) std::puts(json_text(state_json(state)).c_str());
  print_state(state, terminal);
  if (arguments.follow) follow(state, arguments.folder, terminal);
  return 0;
}

int sweep_summary_command(const SweepFolderArguments& arguments) {
  const SweepSummary summary = gather_sweep(arguments.folder).summary;
  if (arguments.common.json) std::puts(json_text(nlohmann::json::parse(summary_as_json(summary))).c_str());
  Terminal(arguments.common.quiet || arguments.common.json).text(format_summary(summary));
  return 0;
}

int sweep_slurm_command(const SweepSlurmArguments& arguments) {
  SlurmJob job;
  job.program = fs::read_symlink("/proc/self/exe");
  job.folder = arguments.folder;
  job.cache = arguments.cache;
  job.array = static_cast<std::size_t>(arguments.array);
  job.throttle = static_cast<std::size_t>(arguments.throttle);
  job.cpus = static_cast<std::size_t>(arguments.cpus);
  job.options = arguments.options;
  const SlurmScripts scripts = write_slurm_scripts(job);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  if (arguments.common.json)
    std::puts(json_text({{"run", scripts.run.string()},
                         {"merge", scripts.merge.string()},
                         {"submit", scripts.submit.string()},
                         {"array", scripts.array}})
                  .c_str());
  terminal.line("slurm      " + std::to_string(scripts.array) + " array tasks and a merge  " + scripts.run.string());
  if (!arguments.submit) {
    terminal.line("submit     bash " + scripts.submit.string() + ", or --submit");
    return 0;
  }
  terminal.text(submit(scripts.submit));
  return 0;
}

}  // namespace rigproof
