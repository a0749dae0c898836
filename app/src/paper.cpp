// `rigproof paper`.
#include "rigproof/study/report/paper.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/study/sweep/sweep.h"
#include "terminal.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

int list_experiments(const PaperArguments& arguments, const Terminal& terminal) {
  nlohmann::json json = nlohmann::json::array();
  for (const PaperExperiment& experiment : paper_experiments()) {
    json.push_back({{"name", experiment.name}, {"title", experiment.title}, {"config", experiment.config}});
    terminal.line(experiment.name + std::string(10 - std::min<std::size_t>(9, experiment.name.size()), ' ') +
                  experiment.title);
  }
  if (arguments.common.json) std::puts(json_text(json).c_str());
  return static_cast<int>(ExitCode::kGood);
}

SweepOptions options_of(const PaperArguments& arguments, const std::string& experiment) {
  const fs::path output = arguments.output.empty() ? fs::path("paper") : arguments.output;
  SweepOptions options;
  options.folder = output / experiment;
  options.cache = arguments.cache.empty() ? output / "cache" : arguments.cache;
  options.jobs = arguments.common.jobs;
  options.device = arguments.device;
  options.keep_going = [] { return !interrupted(); };
  return options;
}

int tell_forecast(const SweepConfig& config, const SweepOptions& options, const PaperArguments& arguments,
                  const Terminal& terminal) {
  const SweepForecast forecast = forecast_sweep(config, options);
  if (arguments.common.json) {
    const nlohmann::json json = {{"tasks", forecast.tasks},
                                 {"answers", forecast.answers},
                                 {"answers_there", forecast.answers_there},
                                 {"images_to_render", forecast.images_to_render},
                                 {"megabytes", forecast.megabytes},
                                 {"minutes", forecast.minutes}};
    std::puts(json_text(json).c_str());
  }
  terminal.line(config.name + ": " + std::to_string(forecast.tasks) + " tasks, " + std::to_string(forecast.answers) +
                " answers, " + std::to_string(forecast.answers_there) + " of them there; about " +
                std::to_string(forecast.images_to_render) + " images to render, " +
                megabytes(1e6 * forecast.megabytes) + ", " + duration(60.0 * forecast.minutes));
  for (const std::string& line : forecast.cannot_run) terminal.line(line);
  return static_cast<int>(ExitCode::kGood);
}

nlohmann::json as_json(const std::vector<PaperTable>& tables, const std::vector<fs::path>& files) {
  nlohmann::json json = {{"tables", nlohmann::json::array()}, {"files", nlohmann::json::array()}};
  for (const PaperTable& table : tables)
    json["tables"].push_back(
        {{"title", table.title}, {"head", table.head}, {"rows", table.rows}, {"notes", table.notes}});
  for (const fs::path& file : files) json["files"].push_back(file.string());
  return json;
}

}  // namespace

int paper_command(const PaperArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  if (arguments.experiment.empty()) return list_experiments(arguments, terminal);
  const PaperExperiment& experiment = find_paper_experiment(arguments.experiment);
  const SweepConfig config = load_sweep_config(
      arguments.config.empty() ? find_data_file("config", experiment.config) : arguments.config, arguments.set);
  SweepOptions options = options_of(arguments, experiment.name);
  if (arguments.dry_run) return tell_forecast(config, options, arguments, terminal);
  ProgressLine progress(terminal, "paper " + experiment.name, "answers");
  options.progress = [&progress](const SweepProgress& state) {
    return progress.update(state.answers_done, state.answers);
  };
  const SweepReport report = run_sweep(config, options);
  if (!report.complete) throw Error("interrupted; the same command goes on", ExitCode::kTryAgain);
  const SweepRows rows = load_sweep_rows(options.folder);
  const std::vector<PaperTable> tables = paper_tables(experiment, rows);
  const std::vector<fs::path> files = write_paper(experiment, rows, options.folder);
  terminal.text(format_paper_tables(tables));
  for (const fs::path& file : files)
    terminal.line((&file == &files.front() ? "figures    " : "           ") + file.string());
  if (arguments.common.json) std::puts(json_text(as_json(tables, files)).c_str());
  return static_cast<int>(ExitCode::kGood);
}

}  // namespace rigproof
