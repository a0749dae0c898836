#include "paper_error_table.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/figures.h"
#include "rigproof/validate/published.h"
#include "rigproof/words/sentences.h"

namespace rigproof::paper {
namespace {

// Published numbers have two decimals.
bool above(double ours, double published) { return std::round(100.0 * ours) > std::round(100.0 * published); }

// The most frequent reason why a method gave nothing.
std::string why_nothing(const SweepRows& rows, const Condition& condition, const std::string& method) {
  std::vector<SweepRow> unsolved;
  for (const SweepRow& row : rows.rows)
    if (row.method == method && meets(row, condition) && !row.reasons.empty()) unsolved.push_back(row);
  const std::vector<FailureCount> failures = count_failures(unsolved);
  return failures.empty() ? std::string() : ": " + words::text_of(failures.front().reasons);
}

void add_method(const std::string& method, const Sample& sample, const PublishedTable& published, PaperTable* table,
                std::string* above_published) {
  const PublishedRow* row = published_row(published, method);
  std::vector<std::string> cells = {method, success_cell(sample)}, theirs;
  if (row != nullptr) theirs = {"  published " + row->method, ""};
  std::string axes;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::optional<double> ours = sample.mean_absolute(i);
    cells.push_back(cell(ours));
    if (row == nullptr) continue;
    theirs.push_back(row->error[i] ? figure(*row->error[i], 2) : "-");
    if (ours && row->error[i] && above(*ours, *row->error[i])) axes += std::string(" ") + kPaperAxes[i];
  }
  table->rows.push_back(cells);
  if (row != nullptr) table->rows.push_back(theirs);
  if (!axes.empty()) *above_published += (above_published->empty() ? "" : "; ") + method + axes;
}

}  // namespace

std::string cell(const std::optional<double>& value) {
  return value ? figure(*value, std::max(2, decimals_for(*value, 2))) : "-";
}

std::string success_cell(const Sample& sample) {
  return std::to_string(sample.success) + "/" + std::to_string(sample.tasks);
}

std::vector<std::string> head_of_axes(const std::string& what, const std::string& count) {
  std::vector<std::string> head = {what, count};
  for (std::size_t i = 0; i < 6; ++i)
    head.push_back(kPaperAxes[i] + std::string(i == 2 ? " [cm]" : i == 5 ? " [deg]" : ""));
  return head;
}

std::string success_note() {
  return "success: tasks in which a method stated for every camera all that it ever states, " + limits_in_words() +
         " of the truth; errors are those of answers so near";
}

std::string far_note(const std::vector<std::pair<std::string, Sample>>& samples) {
  std::string text;
  for (const auto& [method, sample] : samples)
    if (sample.far > 0)
      text += (text.empty() ? "far off: " : "; ") + method + " " + std::to_string(sample.far) + " of " +
              std::to_string(sample.answers) + " answers";
  return text;
}

PaperTable error_table(const SweepRows& rows, const Condition& condition, SweepSubject subject, bool synthetic,
                       const std::string& title) {
  PaperTable table;
  table.title = title;
  table.head = head_of_axes("mean |error|", "success");
  std::string above_published;
  std::vector<std::string> silent;
  std::vector<std::pair<std::string, Sample>> samples;
  for (const std::string& method : rows.methods) {
    const Sample sample = sample_of(rows, condition, method, subject);
    if (sample.answers > 0) {
      add_method(method, sample, published_table(subject, synthetic), &table, &above_published);
      samples.emplace_back(method, sample);
    } else if (sample.tasks > 0) {
      silent.push_back(method + " says nothing about " + subject_title(subject) + why_nothing(rows, condition, method));
    }
  }
  table.notes = {
      above_published.empty() ? "no mean is above the published one" : "above the published mean: " + above_published,
      success_note()};
  if (const std::string far = far_note(samples); !far.empty()) table.notes.push_back(far);
  table.notes.insert(table.notes.end(), silent.begin(), silent.end());
  return table;
}

}  // namespace rigproof::paper
