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
#include "rigproof/core/text.h"
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

std::vector<Result> results_beside(const Input& input) {
  const std::filesystem::path folder = product_folder(input) / "results";
  std::vector<Result> results = load_results(folder);
  if (results.empty())
    throw Error(folder.string() + ": holds no result; make one with: rigproof calibrate " + input.path.string());
  return results;
}

std::filesystem::path report_sweep(const ReportArguments& arguments, const Terminal& terminal) {
  if (!arguments.method.empty()) throw Error("--method: the report of a sweep shows all of its methods");
  if (!arguments.budget.empty()) throw Error("--budget: judges one run against its truth, not a sweep");
  const std::filesystem::path& folder = arguments.inputs.front();
  const std::filesystem::path file = arguments.output.empty() ? folder / kReportName : arguments.output;
  write_file_atomically(file, page_html(sweep_page_content(load_sweep_rows(folder))));
  terminal.line("report     " + file.string());
  return file;
}

std::filesystem::path report_calibration(const ReportArguments& arguments, const Terminal& terminal) {
  const Budget budget = budget_of(arguments.budget);
  InspectInput scene;
  scene.input = open_input(arguments.inputs.front());
  const std::filesystem::path file = product_place(scene.input, arguments.output, kReportName);
  scene.results = results_beside(scene.input);
  scene.truth = truth_beside(scene.input);
  scene.observations = observations_for(scene.input, arguments.common.jobs, terminal);
  write_report(scene, file, {arguments.method, budget, arguments.common.jobs}, terminal);
  return file;
}

Result result_of_method(const Input& input, const std::string& method) {
  const std::string wanted = method.empty() ? "ml" : method;
  const std::vector<Result> results = results_beside(input);
  if (const std::optional<std::size_t> found = find_result(results, method)) return results[*found];
  std::vector<std::string> known;
  for (const Result& result : results) known.push_back(result.method);
  throw Error(input.path.string() + ": there is no result of " + for_message(wanted) + "; " +
              suggestion(wanted, known));
}

std::filesystem::path report_history(const ReportArguments& arguments, const Terminal& terminal) {
  if (!arguments.budget.empty()) throw Error("--budget: judges one run against its truth, not several recordings");
  std::vector<HistoryEntry> entries;
  std::filesystem::path file;
  for (const std::filesystem::path& path : arguments.inputs) {
    const Input input = open_input(path);
    const std::filesystem::path name = path.has_filename() ? path : path.parent_path();
    Result result = result_of_method(input, arguments.method);
    Observations observations = observations_for(input, arguments.common.jobs, terminal);
    entries.push_back({name.string(), std::move(observations), std::move(result)});
    file = product_place(input, arguments.output, "history.html");
  }
  write_file_atomically(file, page_html(history_page_content(std::move(entries))));
  terminal.line("report     " + file.string());
  return file;
}

std::filesystem::path write_any_report(const ReportArguments& arguments, const Terminal& terminal) {
  if (arguments.inputs.size() > 1) return report_history(arguments, terminal);
  return has_file(arguments.inputs.front(), "sweep.yaml") ? report_sweep(arguments, terminal)
                                                          : report_calibration(arguments, terminal);
}

}  // namespace

int report_command(const ReportArguments& arguments) {
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const std::filesystem::path file = write_any_report(arguments, terminal);
  if (arguments.common.json) std::puts(json_text({{"report", file.string()}}).c_str());
  return 0;
}

}  // namespace rigproof
