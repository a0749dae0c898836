// `rigproof validate`.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <utility>

#include "commands.h"
#include "judging.h"
#include "observing.h"
#include "rigproof/core/bag_name.h"
#include "rigproof/core/error.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/validate/bound.h"
#include "rigproof/validate/format.h"
#include "rigproof/words/sentences.h"
#include "terminal.h"

namespace rigproof {
namespace {

std::vector<std::filesystem::path> result_files_of(const ValidateArguments& arguments, const RunFolder& run) {
  if (!arguments.results.empty()) return arguments.results;
  std::vector<std::filesystem::path> files = result_files(run.results());
  if (files.empty())
    throw Error(run.results().string() + ": holds no result; make one with: rigproof calibrate " + run.root.string());
  return files;
}

Truth truth_of(const RunFolder& run) {
  refuse_bag(run.root);
  if (!std::filesystem::is_regular_file(run.truth_file()))
    throw Error(run.truth_file().string() + ": there is no truth to compare with; validate needs a generated run");
  return load_truth(run.truth_file());
}

// "theirs.yaml" for a file that the user named, "ml" for one of the run's own.
std::string subject_of(const std::filesystem::path& file, const ValidateArguments& arguments) {
  return arguments.results.empty() ? file.stem().string() : file.filename().string();
}

// What the run's own results make of the same data. One that cannot be read only is not compared with.
std::vector<Comparison> comparisons_of_run(const RunFolder& run, const Truth& truth,
                                           const std::vector<ValidationRecord>& records) {
  std::vector<Comparison> comparisons;
  if (all_passed(records)) return comparisons;
  for (const std::filesystem::path& file : result_files(run.results())) {
    try {
      comparisons.push_back(compare(load_result(file), truth));
    } catch (const Error&) {
      continue;
    }
  }
  return comparisons;
}

// The run's own, else those of an earlier look at its images.
std::optional<Observations> observations_at_hand(const RunFolder& run) {
  if (std::filesystem::is_regular_file(run.observations_file())) return load_observations(run.observations_file());
  try {
    return observed_before(open_input(run.root));
  } catch (const Error&) {
    return std::nullopt;  // without its recording a run can be judged as well
  }
}

// What the data allow, where the observations are at hand. Those that cannot be read are a record, too.
std::optional<DataBound> bound_of_run(const RunFolder& run, const Truth& truth,
                                      std::vector<ValidationRecord>* records) {
  try {
    const std::optional<Observations> observations = observations_at_hand(run);
    return observations ? data_bound(*observations, truth) : std::nullopt;
  } catch (const Error& error) {
    ValidationRecord& record = records->emplace_back();
    record.subject = run.observations_file().filename().string();
    record.unreadable = error.what();
    return std::nullopt;
  }
}

// A file that cannot be judged is a record, too: a pipeline looks at the JUnit file, not at the screen.
ValidationRecord record_of(const std::filesystem::path& file, const ValidateArguments& arguments, const Truth& truth,
                           const Budget& budget) {
  ValidationRecord record;
  record.subject = subject_of(file, arguments);
  record.budget = budget;
  try {
    Verdict verdict = judge(load_result(file), truth, budget, file.string());
    record.comparison = std::move(verdict.comparison);
    record.gate = std::move(verdict.gate);
  } catch (const Error& error) {
    record.unreadable = error.what();
  }
  return record;
}

void throw_if_unreadable(const std::vector<ValidationRecord>& records) {
  std::vector<std::string> messages;
  for (const ValidationRecord& record : records)
    if (!record.unreadable.empty()) messages.push_back(record.unreadable);
  if (!messages.empty()) throw Error(joined(messages, "\n"));
}

}  // namespace

bool all_passed(const std::vector<ValidationRecord>& records) {
  return std::all_of(records.begin(), records.end(), [](const auto& record) { return record.gate.passed(); });
}

int validate_command(const ValidateArguments& arguments) {
  const RunFolder run{arguments.run};
  const Truth truth = truth_of(run);
  Budget budget = budget_of(arguments.budget);
  budget.nothing_suspected |= !arguments.junit.empty();
  std::vector<ValidationRecord> records;
  for (const std::filesystem::path& file : result_files_of(arguments, run))
    records.push_back(record_of(file, arguments, truth, budget));
  const std::optional<DataBound> bound = bound_of_run(run, truth, &records);
  for (ValidationRecord& record : records) record.comparison.bound = bound;
  if (!arguments.junit.empty()) save_junit(records, arguments.junit, words::sentence_of);
  std::vector<ValidationRecord> judged;
  std::copy_if(records.begin(), records.end(), std::back_inserter(judged),
               [](const ValidationRecord& record) { return record.unreadable.empty(); });
  if (arguments.common.json && !judged.empty()) std::puts(to_json(judged, words::sentence_of).c_str());
  const Terminal terminal(arguments.common.quiet || arguments.common.json);
  const std::vector<Comparison> same_run = comparisons_of_run(run, truth, judged);
  for (const ValidationRecord& record : judged) {
    if (&record != &judged.front()) terminal.line();
    terminal.text(format_validation(record.comparison, record.gate, record.budget, record.subject, words::sentence_of));
    terminal.text(format_same_run(record.comparison, record.budget, same_run));
    if (arguments.paper) terminal.text(format_paper(record.comparison));
  }
  terminal.text(bound ? format_bound(*bound) : "");
  if (!bound && !all_passed(judged))
    terminal.line("What the data allow is not known: `rigproof observe " + shell_word(run.root.string()) +
                  "` looks at the images for it.");
  throw_if_unreadable(records);
  return static_cast<int>(all_passed(records) ? ExitCode::kGood : ExitCode::kGateFailed);
}

}  // namespace rigproof
