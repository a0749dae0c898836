#include "paper_why.h"

#include <algorithm>
#include <array>

#include "paper_csv.h"
#include "paper_error_table.h"
#include "paper_samples.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/figures.h"

namespace rigproof::paper {
namespace {

constexpr std::array<SummaryAxis, 6> kAxes = {SummaryAxis::kTx,   SummaryAxis::kTy,    SummaryAxis::kTz,
                                              SummaryAxis::kRoll, SummaryAxis::kPitch, SummaryAxis::kYaw};

struct Step {
  std::string method, what;
  std::array<std::optional<double>, 6> mean;
  std::array<PairedTest, 6> change;  ///< against the step before; empty for the first one
};

// What a method replaces in the one before it.
std::string what_of(const std::string& method) {
  if (method == "joint_memroc_reference") return "the authors' chain";
  if (method == "joint_memroc") return "each pair once, outliers by the data, every two views";
  if (method == "ml") return "odometry by its own noise";
  for (const Method* link : memroc_chain_methods())
    if (link->traits().name == method) return link->traits().summary;
  return method;
}

// Of the later method against the earlier, by axis.
std::array<PairedTest, 6> change_between(const SweepRows& rows, const std::string& earlier, const std::string& later,
                                         SweepSubject subject) {
  SweepRows two = rows;
  two.methods = {earlier, later};
  two.reference = earlier;
  two.pooled.assign(rows.axes.size(), true);
  two.rows.erase(std::remove_if(two.rows.begin(), two.rows.end(),
                                [&](const SweepRow& row) { return row.method != earlier && row.method != later; }),
                 two.rows.end());
  std::array<PairedTest, 6> change;
  for (const SummaryRow& row : summarise(two).rows) {
    const auto* const axis = std::find(kAxes.begin(), kAxes.end(), row.axis);
    if (row.method == later && row.subject == subject && axis != kAxes.end())
      change[static_cast<std::size_t>(axis - kAxes.begin())] = row.against_reference;
  }
  return change;
}

std::vector<Step> steps_of(const SweepRows& rows, SweepSubject subject) {
  std::vector<Step> steps;
  for (const std::string& method : rows.methods) {
    const Sample sample = sample_of(rows, {}, method, subject);
    if (sample.answers == sample.far) continue;
    Step step{method, what_of(method), {}, {}};
    for (std::size_t i = 0; i < 6; ++i) step.mean[i] = sample.mean_absolute(i);
    if (!steps.empty()) step.change = change_between(rows, steps.back().method, method, subject);
    steps.push_back(step);
  }
  return steps;
}

std::string mean_cell(const std::optional<double>& mean) {
  return mean ? figure(*mean, std::max(2, decimals_for(*mean, 2))) : "-";
}

// "-.41+-.12", half of the interval.
std::string change_cell(const PairedTest& change) {
  if (!change.difference) return "-";
  const int decimals = std::max(2, decimals_for(*change.difference, 2));
  std::string text = signed_figure(*change.difference, decimals);
  if (change.interval_low && *change.interval_high > *change.interval_low)
    text += "+-" + figure(0.5 * (*change.interval_high - *change.interval_low), decimals);
  return text;
}

PaperTable table_of(const SweepRows& rows, SweepSubject subject) {
  PaperTable table;
  table.title = std::string("Where the error comes from, ") + subject_title(subject);
  table.head = {"mean |error|", "tx", "ty", "tz [cm]", "roll", "pitch", "yaw [deg]"};
  const std::vector<Step> steps = steps_of(rows, subject);
  for (const Step& step : steps) {
    std::vector<std::string> means = {step.method}, changes = {"  change"};
    for (std::size_t i = 0; i < 6; ++i) {
      means.push_back(mean_cell(step.mean[i]));
      changes.push_back(change_cell(step.change[i]));
    }
    table.rows.push_back(means);
    if (&step != &steps.front()) table.rows.push_back(changes);
    if (subject == SweepSubject::kPair) table.notes.push_back(step.method + ": " + step.what);
  }
  return table;
}

std::string lines_of(const SweepRows& rows, SweepSubject subject) {
  std::string text;
  double place = 0.0;
  for (const Step& step : steps_of(rows, subject)) {
    for (std::size_t i = 0; i < 6; ++i) {
      const PairedTest& change = step.change[i];
      for (const auto& [source, value] : {std::make_pair("mean", step.mean[i]),
                                          {"change", change.difference},
                                          {"low", change.interval_low},
                                          {"high", change.interval_high}}) {
        if (!value) continue;
        CsvLine line;
        line.figure = "waterfall";
        line.panel = subject_title(subject);
        line.quantity = kPaperAxes[i];
        line.unit = i < 3 ? "cm" : "deg";
        line.method = step.method;
        line.source = source;
        line.x = place;
        line.x_title = step.what;
        line.error = *value;
        text += text_of(line);
      }
    }
    place += 1.0;
  }
  return text;
}

}  // namespace

std::vector<PaperTable> tables_of_why(const SweepRows& rows) {
  std::vector<PaperTable> tables = {table_of(rows, SweepSubject::kCamera), table_of(rows, SweepSubject::kPair)};
  tables.back().notes.push_back(
      "changes with half their 95 % interval over the odometry's drawings; those of one world share its pictures");
  tables.back().notes.push_back("of answers " + limits_in_words() + " of the truth");
  std::vector<std::pair<std::string, Sample>> samples;
  for (const std::string& method : rows.methods)
    samples.emplace_back(method, sample_of(rows, {}, method, SweepSubject::kCamera));
  if (const std::string far = far_note(samples); !far.empty()) tables.back().notes.push_back(far);
  return tables;
}

std::string why_csv(const SweepRows& rows) {
  return lines_of(rows, SweepSubject::kCamera) + lines_of(rows, SweepSubject::kPair);
}

}  // namespace rigproof::paper
