// `rigproof run`: generate, calibrate, validate, and draw the pictures and the report.
#include <cstdio>
#include <thread>

#include "acceptance.h"
#include "commands.h"
#include "generating.h"
#include "judging.h"
#include "observing.h"
#include "print_result.h"
#include "reporting.h"
#include "rigproof/core/error.h"
#include "rigproof/study/export/export.h"
#include "rigproof/study/report/inspect.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/validate/bound.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/proof.h"
#include "rigproof/words/sentences.h"

namespace rigproof {
namespace {

std::string headline(const GenerateConfig& config, const std::string& gl_renderer, int jobs) {
  const unsigned cores = jobs > 0 ? static_cast<unsigned>(jobs) : std::thread::hardware_concurrency();
  return config.scene + ", " + config.rig + ", seed " + std::to_string(config.seed) + ", " +
         gl_renderer.substr(0, gl_renderer.find(" (")) + " on " + std::to_string(cores) +
         (cores == 1 ? " core" : " cores");
}

/// Solves with every method, saves each result and judges it.
std::vector<ValidationRecord> solve_and_judge(const RunArguments& arguments, const RunFolder& run,
                                              const MethodInput& input, const Terminal& terminal, bool* all_solved) {
  const Truth truth = load_truth(run.truth_file());
  Budget budget = budget_of(arguments.budget);
  budget.nothing_suspected |= !arguments.junit.empty();
  const std::optional<Gates> gates = gates_for(arguments.accept, input.observations.accept);
  const std::optional<DataBound> bound = data_bound(input.observations, truth);
  std::vector<ValidationRecord> records;
  std::vector<Comparison> comparisons;
  for (const auto& method : methods_by_name(arguments.methods, {run.results(), [] { return !interrupted(); }})) {
    Result result = run_with_progress(*method, input, terminal);
    result.method = result_name(result.method, arguments.vision);
    const WrittenFile written =
        write_with_backup(run.result_file(result.method), result_text(result, words::sentence_of));
    *all_solved = *all_solved && result.status == ResultStatus::kSolved;
    terminal.line("calibrate  " + result.method + "  " + use_in_short(result) + "  " + duration(result.solve_s) +
                  (written.backup ? "  (before: " + written.backup->string() + ")" : ""));
    if (result.status == ResultStatus::kSolved)
      print_also_estimated(terminal, result);
    else
      print_result(terminal, result);
    if (result.status == ResultStatus::kSolved) print_suspicions(terminal, result);
    Verdict verdict = judge(result, truth, budget);
    verdict.comparison.bound = bound;
    records.push_back({result.method, verdict.comparison, budget, verdict.gate});
    comparisons.push_back(verdict.comparison);
    Comparison shown = verdict.comparison;
    if (result.status != ResultStatus::kSolved) shown.reasons.clear();  // print_result() gave them
    terminal.text(format_verdict(verdict.comparison, verdict.gate, budget, words::sentence_of));
    terminal.text(format_suspicion(verdict.comparison, words::sentence_of));
    terminal.text(format_errors(shown, &verdict.gate, words::sentence_of));
    if (result.status == ResultStatus::kSolved) print_main_sources(terminal, result);
    terminal.text(format_same_run(verdict.comparison, budget, comparisons));
    const auto report = gates ? judge_acceptance(terminal, *method, result, input.observations, *gates) : std::nullopt;
    if (report) records.push_back(acceptance_record(result, *report, gates->criteria));
  }
  return records;
}

void prove_and_say(const RunFolder& run, const Input& input, const Observations& observations,
                   const Terminal& terminal) {
  const Proof proof = prove_run(run, input, observations, words::sentence_of);
  if (proof.passed) return;
  terminal.text(format_proof(proof, words::sentence_of));
  throw Error(run.proof_file().string() + ": the run contradicts its own truth; its results mean nothing",
              ExitCode::kGateFailed);
}

}  // namespace

int run_command(const RunArguments& arguments) {
  const GenerateConfig config = configuration_of(arguments.generate);
  const auto methods = methods_by_name(arguments.methods);  // an unknown method is told before anything is rendered
  const Vision vision(arguments.vision);
  budget_of(arguments.budget);
  if (!arguments.accept.empty()) accept_criteria_of(arguments.accept);
  if (arguments.generate.dry_run) return print_plan(arguments.generate, config);
  const CommonArguments& common = arguments.generate.common;
  const Terminal terminal(common.quiet || common.json);
  const RunFolder run{output_of(arguments.generate, config)};
  for (const auto& method : methods)
    check_can_be_written(run.result_file(result_name(method->traits().name, arguments.vision)));
  if (!arguments.junit.empty()) check_can_be_written(arguments.junit);
  RunsAhead ahead({{arguments.generate, config}});
  generate_with_progress(&ahead, 0, terminal, [&](const std::string& gl_renderer) {
    terminal.line(terminal.colored(headline(config, gl_renderer, common.jobs), Color::kDim));
  });
  const Input input = open_input(run.root);
  const Observations observations = observe_with_progress(input, vision, common.jobs, terminal);
  save_observations(observations, run.observations_file());
  prove_and_say(run, input, observations, terminal);
  bool all_solved = true;
  const std::vector<ValidationRecord> records =
      solve_and_judge(arguments, run, method_input(input, observations, vision, common.jobs), terminal, &all_solved);
  if (!arguments.junit.empty()) save_junit(records, arguments.junit, words::sentence_of);
  const InspectInput scene{input, observations, load_truth(run.truth_file()), load_results(run.results())};
  write_pictures(scene, run.pictures());
  terminal.line("pictures   " + run.pictures().string());
  write_report(scene, run.root / kReportName, {records.front().subject, budget_of(arguments.budget), common.jobs},
               terminal);
  if (common.json) std::puts(to_json(records, words::sentence_of).c_str());
  if (!all_solved) return static_cast<int>(ExitCode::kRefused);
  return static_cast<int>(all_passed(records) ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace rigproof
