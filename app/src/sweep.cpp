// `rigproof sweep`.
#include "rigproof/study/sweep/sweep.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
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
  terminal.line("about " + duration(60.0 * forecast.minutes));
  terminal.line("would write " + options.folder.string());
  return 0;
}

std::string counters_text(const SweepCounters& counters) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counters)
    if (count > 0) parts.push_back(std::to_string(count) + " " + name);
  return joined(parts);
}

SweepReport run_with_progress(const SweepConfig& config, SweepOptions options, const Terminal& terminal) {
  ProgressLine line(terminal, "sweep", "images and answers");
  options.progress = [&line](const SweepProgress& progress) {
    line.update(progress.images_done + progress.answers_done, progress.images + progress.answers);
  };
  return run_sweep(config, options);
}

}  // namespace

int sweep_start_command(const SweepStartArguments& arguments) {
  const SweepConfig config = load_sweep_config(file_of(arguments), arguments.set);
  const SweepOptions options = options_of(arguments, config);
  const CommonArguments& common = arguments.common;
  if (arguments.dry_run) return print_forecast(forecast_sweep(config, options), options, common);
  const Terminal terminal(common.quiet || common.json);
  const SweepReport report = run_with_progress(config, options, terminal);
  if (!report.complete)
    throw Error("interrupted; the same command goes on with " + options.folder.string(), ExitCode::kTryAgain);
  const SweepSummary summary = summarise(load_sweep_rows(options.folder));
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

int sweep_status_command(const SweepFolderArguments& arguments) {
  const SweepState state = sweep_state(arguments.folder);
  if (arguments.common.json) {
    nlohmann::json failures = nlohmann::json::array();
    for (const FailureCount& failure : state.failures)
      failures.push_back({{"method", failure.method},
                          {"status", sweep_status_name(failure.status)},
                          {"code", failure.code},
                          {"reason", failure.reason},
                          {"tasks", failure.tasks}});
    const nlohmann::json json = {{"name", state.name},        {"tasks", state.tasks},
                                 {"answers", state.answers},  {"answers_there", state.answers_there},
                                 {"running", state.running},  {"failures", failures},
                                 {"counters", state.counters}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  const Terminal terminal(arguments.common.quiet);
  terminal.line(state.name + "  " + std::to_string(state.answers_there) + "/" + std::to_string(state.answers) +
                " answers of " + std::to_string(state.tasks) + " tasks" + (state.running ? ", running" : ""));
  for (const FailureCount& failure : state.failures)
    terminal.line(" " + std::to_string(failure.tasks) + " x " + failure.method + " " +
                  sweep_status_name(failure.status) + ": " + for_message(failure.reason, kShownReason));
  if (!state.counters.empty()) terminal.line("all starts: " + counters_text(state.counters));
  return 0;
}

int sweep_summary_command(const SweepFolderArguments& arguments) {
  const SweepSummary summary = gather_sweep(arguments.folder);
  if (arguments.common.json) std::fputs(summary_as_json(summary).c_str(), stdout);
  Terminal(arguments.common.quiet || arguments.common.json).text(format_summary(summary));
  return 0;
}

}  // namespace rigproof
