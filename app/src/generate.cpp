// `rigproof generate`.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "archiving.h"
#include "commands.h"
#include "generating.h"
#include "json_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/dataset.h"
#include "rigproof/study/sweep/observed_run.h"
#include "rigproof/study/sweep/run_config.h"

namespace rigproof {
GenerateConfig configuration_of(const GenerateArguments& arguments) {
  return run_config(arguments.config, arguments.set);
}

std::filesystem::path output_of(const GenerateArguments& arguments, const GenerateConfig& config) {
  return arguments.output.empty() ? std::filesystem::path("runs") / config.name : arguments.output;
}

namespace {

GenerateOptions options_of(const GenerateArguments& arguments, const GenerateConfig& config) {
  GenerateOptions options;
  options.output = output_of(arguments, config);
  options.jobs = arguments.common.jobs;
  options.fresh = arguments.fresh;
  options.device = arguments.device;
  options.cache = arguments.cache;
  options.render = arguments.render;
  return options;
}

}  // namespace

RunsAhead::~RunsAhead() {
  given_up_ = true;
  if (prepared_.valid()) prepared_.wait();
}

void RunsAhead::start(std::size_t number) {
  number_ = number;
  viewpoints_done_ = viewpoints_ = 0;
  GenerateOptions options = options_of(runs_[number].arguments, runs_[number].config);
  options.on_the_way = [this](std::size_t done, std::size_t all) {
    viewpoints_done_ = done;
    viewpoints_ = all;
    return !given_up_ && !interrupted();
  };
  prepared_ = std::async(std::launch::async, [&config = runs_[number].config, options = std::move(options)] {
    return prepare_generation(config, options);
  });
}

void RunsAhead::start_next() {
  if (number_ + 1 < runs_.size()) start(number_ + 1);
}

std::shared_ptr<const Scenario> RunsAhead::take(std::size_t number, const Terminal& terminal) {
  if (!prepared_.valid() || number_ != number) start(number);
  ProgressLine progress(terminal, "drive", "viewpoints");
  while (prepared_.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready)
    if (viewpoints_ > 0) progress.update(viewpoints_done_, viewpoints_);
  return prepared_.get();
}

GenerateReport generate_with_progress(RunsAhead* ahead, std::size_t number, const Terminal& terminal,
                                      const std::function<void(const std::string& gl_renderer)>& on_renderer) {
  const auto& [arguments, config] = ahead->runs()[number];
  GenerateOptions options = options_of(arguments, config);
  bool told = false;
  options.on_renderer = [&](const std::string& gl_renderer) {
    told = true;
    if (on_renderer) on_renderer(gl_renderer);
  };
  options.on_started = [ahead] { ahead->start_next(); };
  const std::shared_ptr<const Scenario> scenario = ahead->take(number, terminal);
  GenerateReport report;
  {
    ProgressLine progress(terminal, "generate", "images");
    options.progress = progress.callback();
    report = arguments.observations ? generate_observed(*scenario, options).report : generate(*scenario, options);
  }
  if (!told && on_renderer) on_renderer(report.gl_renderer);
  if (!report.complete)
    throw Error("interrupted; the same command resumes " + options.output.string(), ExitCode::kTryAgain);
  const std::string count = std::to_string(report.images) + "/" + std::to_string(report.images) + " images";
  const std::string size = "  " + megabytes(static_cast<double>(report.bytes));
  if (report.images_rendered == 0) {
    terminal.line("generate   " + count + "  all there already" + size);
  } else {
    const double rate = static_cast<double>(report.images_rendered) / report.seconds;
    terminal.line("generate   " + count + "  " + fixed_text(rate, 0) + "/s  " + duration(report.seconds) + size +
                  (report.images_rendered < report.images ? "  (resumed)" : ""));
  }
  return report;
}

namespace {

nlohmann::json json_of(const CameraCoverage& seen, const CameraCoverage& possible) {
  return {{"name", seen.camera},           {"board_stops", seen.stops},
          {"cells", seen.cells},           {"possible_cells", possible.cells},
          {"top_row_px", seen.top_row_px}, {"bottom_row_px", seen.bottom_row_px}};
}

void print_cameras(const GeneratePlan& plan, const Terminal& terminal) {
  std::size_t width = 0;
  for (const CameraCoverage& camera : plan.cameras) width = std::max(width, camera.camera.size());
  for (std::size_t i = 0; i < plan.cameras.size(); ++i) {
    const CameraCoverage& camera = plan.cameras[i];
    terminal.line(" " + camera.camera + std::string(width + 2 - camera.camera.size(), ' ') +
                  describe_camera(camera, plan.possible[i], plan.viewpoints));
  }
}

}  // namespace

int print_plan(const GenerateArguments& arguments, const GenerateConfig& config) {
  GenerateOptions options = options_of(arguments, config);
  options.on_the_way = [](std::size_t, std::size_t) { return !interrupted(); };
  const GeneratePlan plan = plan_generation(config, options);
  if (arguments.common.json) {
    nlohmann::json cameras = nlohmann::json::array();
    for (std::size_t i = 0; i < plan.cameras.size(); ++i) cameras.push_back(json_of(plan.cameras[i], plan.possible[i]));
    const nlohmann::json json = {{"stops", plan.stops},
                                 {"images", plan.images},
                                 {"pictures", plan.pictures},
                                 {"expected_mb", plan.expected_mb},
                                 {"expected_minutes", plan.expected_minutes},
                                 {"output", output_of(arguments, config).string()},
                                 {"coverage", plan.coverage},
                                 {"cameras", cameras}};
    std::puts(json_text(json).c_str());
    return 0;
  }
  const Terminal terminal(arguments.common.quiet);
  const std::string parts =
      plan.pictures == plan.images ? "" : " put together from " + std::to_string(plan.pictures) + " pictures";
  terminal.line(std::to_string(plan.stops) + " stops, " + std::to_string(plan.images) + " images" + parts + ", about " +
                megabytes(plan.expected_mb * 1e6) + " and " + duration(plan.expected_minutes * 60.0));
  terminal.line(plan.coverage);
  print_cameras(plan, terminal);
  terminal.line("would write " + output_of(arguments, config).string());
  return 0;
}

namespace {

// The folder of one of a data set's runs: below the output, by its world.
GenerateArguments arguments_of(const GenerateArguments& all, const GenerateConfig& run, bool many) {
  GenerateArguments arguments = all;
  const std::filesystem::path name = std::filesystem::path(run.name).filename();
  if (many && !all.output.empty()) arguments.output = all.output / name;
  if (many && !all.archive.empty()) arguments.archive = all.archive / name;
  return arguments;
}

void archive(const GenerateArguments& arguments, const std::filesystem::path& run, const Terminal& terminal) {
  const std::string name = "archive    " + arguments.archive.string() + "  ";
  if (is_archive_of(run, arguments.archive)) return terminal.line(name + "there already");
  ProgressLine progress(terminal, "archive", "files");
  const std::string what = write_shards(run, arguments.archive, arguments.shard_mib, &progress);
  terminal.line(name + what);
}

int generate_one(RunsAhead* ahead, std::size_t number) {
  const auto& [arguments, config] = ahead->runs()[number];
  if (arguments.dry_run) return print_plan(arguments, config);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const GenerateReport report = generate_with_progress(ahead, number, terminal);
  const std::filesystem::path output = output_of(arguments, config);
  if (arguments.common.json) {
    const nlohmann::json json = {
        {"run", output.string()},     {"images", report.images},   {"images_rendered", report.images_rendered},
        {"bytes", report.bytes},      {"seconds", report.seconds}, {"gl_renderer", report.gl_renderer},
        {"coverage", report.coverage}};
    std::puts(json_text(json).c_str());
  }
  terminal.line(report.coverage);
  if (arguments.observations) terminal.line("observations  " + RunFolder{output}.observations_file().string());
  terminal.line("run        " + output.string());
  if (!arguments.archive.empty()) archive(arguments, output, terminal);
  return 0;
}

}  // namespace

int generate_command(const GenerateArguments& arguments) {
  const std::vector<GenerateConfig> configs = runs_of(configuration_of(arguments));
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const bool many = configs.size() > 1;
  std::vector<RunsAhead::Run> runs;
  for (const GenerateConfig& config : configs) {
    runs.push_back({arguments_of(arguments, config, many), config});
    const GenerateArguments& one = runs.back().arguments;
    if (!one.archive.empty()) check_archive(output_of(one, config), one.archive);
  }
  RunsAhead ahead(std::move(runs));
  if (many && arguments.common.json) std::puts("[");
  for (std::size_t i = 0; i < configs.size(); ++i) {
    if (many) terminal.line(std::to_string(i + 1) + "/" + std::to_string(configs.size()) + "  " + configs[i].name);
    generate_one(&ahead, i);
    if (many && arguments.common.json) std::puts(i + 1 < configs.size() ? "," : "]");
  }
  return 0;
}

}  // namespace rigproof
