// `rigproof generate`.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "generating.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/dataset.h"
#include "rigproof/study/overrides.h"

namespace rigproof {
namespace {

constexpr const char* kOverridesName = "--set";

std::string rounded(double value, const char* format) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

GenerateConfig configuration_of(const GenerateArguments& arguments) {
  const bool has_file = !arguments.config.empty();
  const std::filesystem::path file =
      has_file ? std::filesystem::absolute(find_data_file("config", arguments.config)) : std::filesystem::path();
  GenerateConfig config = has_file ? load_generate_config(file) : parse_generate_config("", "default");
  if (arguments.set.empty()) return config;
  const std::string include = has_file ? "include: \"" + file.string() + "\"\n" : "";
  GenerateConfig changed = parse_generate_config(include + overrides_as_yaml(arguments.set), kOverridesName);
  if (changed.name.empty() || changed.name == kOverridesName) changed.name = config.name;
  return changed;
}

std::filesystem::path output_of(const GenerateArguments& arguments, const GenerateConfig& config) {
  return arguments.output.empty() ? std::filesystem::path("runs") / config.name : arguments.output;
}

GenerateReport generate_with_progress(const GenerateArguments& arguments, const GenerateConfig& config,
                                      const Terminal& terminal,
                                      const std::function<void(const std::string& gl_renderer)>& on_renderer) {
  GenerateOptions options;
  bool told = false;
  options.on_renderer = [&](const std::string& gl_renderer) {
    told = true;
    if (on_renderer) on_renderer(gl_renderer);
  };
  options.output = output_of(arguments, config);
  options.jobs = arguments.common.jobs;
  options.fresh = arguments.fresh;
  options.device = arguments.device;
  options.cache = arguments.cache;
  options.render = arguments.render;
  GenerateReport report;
  {
    ProgressLine progress(terminal, "generate", "images");
    options.progress = progress.callback();
    report = generate(config, options);
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
    terminal.line("generate   " + count + "  " + rounded(rate, "%.0f/s") + "  " + duration(report.seconds) + size +
                  (report.images_rendered < report.images ? "  (resumed)" : ""));
  }
  return report;
}

int print_plan(const GenerateArguments& arguments, const GenerateConfig& config) {
  const GeneratePlan plan = plan_generation(config);
  if (arguments.common.json) {
    const nlohmann::json json = {{"stops", plan.stops},
                                 {"images", plan.images},
                                 {"expected_mb", plan.expected_mb},
                                 {"expected_minutes", plan.expected_minutes},
                                 {"output", output_of(arguments, config).string()},
                                 {"coverage", plan.coverage}};
    std::puts(json.dump(2).c_str());
    return 0;
  }
  const Terminal terminal(arguments.common.quiet);
  terminal.line(std::to_string(plan.stops) + " stops, " + std::to_string(plan.images) + " images, about " +
                megabytes(plan.expected_mb * 1e6) + " and " + duration(plan.expected_minutes * 60.0));
  terminal.line(plan.coverage);
  terminal.line("would write " + output_of(arguments, config).string());
  return 0;
}

namespace {

// The folder of one of a data set's runs: below the output, by its world.
GenerateArguments arguments_of(const GenerateArguments& all, const GenerateConfig& run, bool many) {
  GenerateArguments arguments = all;
  if (many && !all.output.empty()) arguments.output = all.output / std::filesystem::path(run.name).filename();
  return arguments;
}

int generate_one(const GenerateArguments& arguments, const GenerateConfig& config) {
  if (arguments.dry_run) return print_plan(arguments, config);
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const GenerateReport report = generate_with_progress(arguments, config, terminal);
  const std::filesystem::path output = output_of(arguments, config);
  if (arguments.common.json) {
    const nlohmann::json json = {
        {"run", output.string()},     {"images", report.images},   {"images_rendered", report.images_rendered},
        {"bytes", report.bytes},      {"seconds", report.seconds}, {"gl_renderer", report.gl_renderer},
        {"coverage", report.coverage}};
    std::puts(json.dump(2).c_str());
  }
  terminal.line(report.coverage);
  terminal.line("run        " + output.string());
  return 0;
}

}  // namespace

int generate_command(const GenerateArguments& arguments) {
  const std::vector<GenerateConfig> runs = runs_of(configuration_of(arguments));
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const bool many = runs.size() > 1;
  if (many && arguments.common.json) std::puts("[");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (many) terminal.line(std::to_string(i + 1) + "/" + std::to_string(runs.size()) + "  " + runs[i].name);
    generate_one(arguments_of(arguments, runs[i], many), runs[i]);
    if (many && arguments.common.json) std::puts(i + 1 < runs.size() ? "," : "]");
  }
  return 0;
}

}  // namespace rigproof
