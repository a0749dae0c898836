// `rigproof report`.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "judging.h"
#include "observing.h"
#include "reporting.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/workflow/workflow.h"

namespace rigproof {

void write_report(const InspectInput& scene, const std::filesystem::path& file, PageOptions options,
                  const Terminal& terminal) {
  {
    ProgressLine progress(terminal, "report", "images");
    options.progress = progress.callback();
    write_page(scene, file, options);
  }
  terminal.line("report     " + file.string());
}

namespace {

// Those that were saved, if they were: `run` and `observe` do.
Observations observations_for(const Input& input, int jobs, const Terminal& terminal) {
  const std::filesystem::path saved = product_folder(input) / "observations.json";
  std::error_code ignored;
  if (!input.observations && std::filesystem::is_regular_file(saved, ignored)) return load_observations(saved);
  return observe_with_progress(input, jobs, terminal);
}

std::filesystem::path report_sweep(const ReportArguments& arguments, const Terminal& terminal) {
  const std::filesystem::path file = arguments.output.empty() ? arguments.input / kReportName : arguments.output;
  write_file_atomically(file, page_html(sweep_page_content(load_sweep_rows(arguments.input))));
  terminal.line("report     " + file.string());
  return file;
}

std::filesystem::path report_calibration(const ReportArguments& arguments, const Terminal& terminal) {
  const Budget budget = budget_of(arguments.budget);
  InspectInput scene;
  scene.input = open_input(arguments.input);
  const std::filesystem::path file = product_place(scene.input, arguments.output, kReportName);
  const std::filesystem::path results = product_folder(scene.input) / "results";
  scene.results = load_results(results);
  if (scene.results.empty())
    throw Error(results.string() + ": holds no result; make one with: rigproof calibrate " + arguments.input.string());
  scene.truth = truth_beside(scene.input);
  scene.observations = observations_for(scene.input, arguments.common.jobs, terminal);
  write_report(scene, file, {arguments.method, budget, arguments.common.jobs}, terminal);
  return file;
}

}  // namespace

int report_command(const ReportArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const std::filesystem::path file = has_file(arguments.input, "sweep.yaml") ? report_sweep(arguments, terminal)
                                                                             : report_calibration(arguments, terminal);
  if (arguments.common.json) std::puts(json_text({{"report", file.string()}}).c_str());
  return 0;
}

}  // namespace rigproof
