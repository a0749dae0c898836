#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "paired_test.h"
#include "rigproof/core/figures.h"
#include "rigproof/study/sweep/rows.h"

namespace rigproof {
namespace {

constexpr std::array<double, 5> kProbabilities = {0.05, 0.25, 0.5, 0.75, 0.95};
constexpr int kAxes = static_cast<int>(SummaryAxis::kRotation) + 1;

struct Value {
  double error = 0.0;
  std::optional<double> bound;
};

std::optional<Value> value_of(const SweepRow& row, SummaryAxis axis) {
  const auto index = static_cast<std::size_t>(axis);
  std::optional<double> error, bound;
  if (axis == SummaryAxis::kTranslation || axis == SummaryAxis::kRotation) {
    const std::size_t first = axis == SummaryAxis::kTranslation ? 0 : 3;
    error = length_of(row.error, first);
    bound = length_of(row.bound, first);
  } else if (index < 6) {
    error = row.error[index];
    bound = row.bound[index];
  } else {
    error = row.roll_pitch_yaw[index - 6];
  }
  if (!error) return std::nullopt;
  return Value{*error, bound};
}

SampleFigures figures_of(const std::vector<Value>& values) {
  SampleFigures figures;
  figures.count = static_cast<int>(values.size());
  if (values.empty()) return figures;
  const double n = static_cast<double>(values.size());
  double sum = 0.0, absolute_sum = 0.0, squares = 0.0, bounded_squares = 0.0, bound_squares = 0.0;
  std::vector<double> sizes;
  for (const Value& value : values) {
    sum += value.error;
    absolute_sum += std::abs(value.error);
    squares += value.error * value.error;
    sizes.push_back(std::abs(value.error));
    if (!value.bound) continue;
    bounded_squares += value.error * value.error;
    bound_squares += *value.bound * *value.bound;
  }
  figures.mean = sum / n;
  figures.mean_absolute = absolute_sum / n;
  figures.rmse = std::sqrt(squares / n);
  if (bound_squares > 0.0) figures.rmse_over_bound = std::sqrt(bounded_squares / bound_squares);
  if (values.size() > 1) {
    double about_mean = 0.0, about_absolute = 0.0;
    for (const Value& value : values) {
      about_mean += std::pow(value.error - *figures.mean, 2);
      about_absolute += std::pow(std::abs(value.error) - *figures.mean_absolute, 2);
    }
    figures.deviation = std::sqrt(about_mean / (n - 1.0));
    figures.deviation_absolute = std::sqrt(about_absolute / (n - 1.0));
  }
  std::sort(sizes.begin(), sizes.end());
  for (std::size_t i = 0; i < kProbabilities.size(); ++i) figures.quantiles[i] = quantile_of(sizes, kProbabilities[i]);
  figures.largest = sizes.back();
  return figures;
}

// What one method said in one task about the cameras (or the pairs), on one axis.
struct TaskValues {
  std::vector<Value> values;
  std::size_t cameras = 0;
  int far = 0;

  bool answered() const { return cameras > 0 && values.size() == cameras; }
  double mean_absolute() const {
    double sum = 0.0;
    for (const Value& value : values) sum += std::abs(value.error);
    return sum / static_cast<double>(values.size());
  }
};

/// The rows of one (task, method).
struct TaskRows {
  std::vector<const SweepRow*> rows;
  const SweepRow* rig = nullptr;

  TaskValues values(SweepSubject subject, SummaryAxis axis) const {
    TaskValues result;
    for (const SweepRow* row : rows) {
      if (row->subject != subject) continue;
      ++result.cameras;
      const std::optional<Value> value = value_of(*row, axis);
      if (value && is_far(*row))
        ++result.far;
      else if (value)
        result.values.push_back(*value);
    }
    return result;
  }
};

// The rows of one point: by place among its tasks, then by method. Tasks without an answer of a method have none.
class PointRows {
 public:
  PointRows(const SweepRows& table, const std::vector<std::size_t>& members,
            const std::function<std::vector<SweepRow>(std::size_t task, std::size_t method)>& rows_of)
      : rows_(members.size()), tasks_(members.size()) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      rows_[i].resize(table.methods.size());
      for (std::size_t method = 0; method < table.methods.size(); ++method) {
        std::vector<SweepRow>& rows = rows_[i][method] = rows_of(members[i], method);
        if (!rows.empty()) add(rows, &tasks_[i][table.methods[method]]);
      }
    }
  }

  const std::vector<std::map<std::string, TaskRows>>& tasks() const { return tasks_; }

 private:
  static void add(const std::vector<SweepRow>& rows, TaskRows* task) {
    for (const SweepRow& row : rows) {
      if (row.subject == SweepSubject::kRig) task->rig = &row;
      task->rows.push_back(&row);
    }
  }

  std::vector<std::vector<std::vector<SweepRow>>> rows_;
  std::vector<std::map<std::string, TaskRows>> tasks_;
};
using ByTask = std::vector<std::map<std::string, TaskRows>>;

void count_status(SweepStatus status, SummaryRow* row) {
  static constexpr std::array<int SummaryRow::*, 6> kCounts = {&SummaryRow::solved,        &SummaryRow::partial,
                                                               &SummaryRow::partial,       &SummaryRow::refused,
                                                               &SummaryRow::could_not_run, &SummaryRow::failed};
  ++(row->*kCounts[static_cast<std::size_t>(status)]);
}

/// One point of the axes that are not pooled, cameras or pairs, one axis: a line for each method.
class Cell {
 public:
  Cell(const SweepRows& table, const ByTask& tasks, SweepSubject subject, SummaryAxis axis)
      : table_(table), subject_(subject), axis_(axis) {
    for (const std::string& method : table.methods) {
      std::vector<TaskValues>& list = values_[method];
      for (const auto& by_method : tasks) {
        const auto rows = by_method.find(method);
        list.push_back(rows == by_method.end() ? TaskValues() : rows->second.values(subject, axis));
      }
    }
  }

  bool is_empty() const {
    return std::all_of(values_.begin(), values_.end(), [](const auto& entry) { return answered(entry.second) == 0; });
  }

  SummaryRow row_of(const std::string& method, std::uint64_t stream) const {
    SummaryRow row;
    row.method = method;
    row.subject = subject_;
    row.axis = axis_;
    const std::vector<TaskValues>& list = values_.at(method);
    row.tasks = static_cast<int>(list.size());
    row.answered = answered(list);
    for (const TaskValues& task : list) row.far += task.far;
    row.success_rate = list.empty() ? 0.0 : static_cast<double>(row.answered) / static_cast<double>(list.size());
    row.all = figures_of(joined_values(list, std::vector<bool>(list.size(), true)));
    row.common = figures_of(joined_values(list, common_tasks()));
    if (method != table_.reference && values_.count(table_.reference) > 0) row.against_reference = test(list, stream);
    return row;
  }

 private:
  static int answered(const std::vector<TaskValues>& list) {
    return static_cast<int>(std::count_if(list.begin(), list.end(), [](const auto& task) { return task.answered(); }));
  }

  static std::vector<Value> joined_values(const std::vector<TaskValues>& list, const std::vector<bool>& wanted) {
    std::vector<Value> values;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (wanted[i]) values.insert(values.end(), list[i].values.begin(), list[i].values.end());
    return values;
  }

  // Those that every method answered which answers this axis here at all.
  std::vector<bool> common_tasks() const {
    const std::size_t count = values_.begin()->second.size();
    std::vector<bool> common(count, !is_empty());
    for (const auto& [method, list] : values_) {
      if (answered(list) == 0) continue;
      for (std::size_t i = 0; i < count; ++i) common[i] = common[i] && list[i].answered();
    }
    return common;
  }

  PairedTest test(const std::vector<TaskValues>& list, std::uint64_t stream) const {
    const std::vector<TaskValues>& reference = values_.at(table_.reference);
    std::vector<double> differences;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (list[i].answered() && reference[i].answered())
        differences.push_back(list[i].mean_absolute() - reference[i].mean_absolute());
    PairedTest test;
    test.count = static_cast<int>(differences.size());
    if (differences.empty()) return test;
    double sum = 0.0;
    for (const double difference : differences) sum += difference;
    test.difference = sum / static_cast<double>(differences.size());
    if (const std::optional<MeanInterval> interval = bootstrap_mean(differences, stream)) {
      test.interval_low = interval->low;
      test.interval_high = interval->high;
    }
    test.p = signed_rank_p(differences);
    return test;
  }

  const SweepRows& table_;
  SweepSubject subject_;
  SummaryAxis axis_;
  std::map<std::string, std::vector<TaskValues>> values_;
};

// Labels of a task on the axes that are not pooled.
std::vector<std::string> point_of(const SweepRows& table, const SweepTask& task) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < task.levels.size(); ++i)
    labels.push_back(table.pooled[i] ? "all" : table.levels[i][task.levels[i]]);
  return labels;
}

// The six axes of one point, method and subject are one question.
void correct_for_number_of_tests(SweepSummary* summary) {
  std::map<std::tuple<std::vector<std::string>, std::string, SweepSubject>, std::vector<PairedTest*>> families;
  for (SummaryRow& row : summary->rows)
    if (row.against_reference.p && row.axis <= SummaryAxis::kRz)
      families[{row.levels, row.method, row.subject}].push_back(&row.against_reference);
  for (const auto& [key, tests] : families) {
    std::vector<double> p;
    for (const PairedTest* test : tests) p.push_back(*test->p);
    const std::vector<double> corrected = holm_corrected(p);
    for (std::size_t i = 0; i < tests.size(); ++i) tests[i]->p_holm = corrected[i];
  }
}

void add_status(const ByTask& tasks, SummaryRow* row) {
  for (const auto& by_method : tasks) {
    const auto rows = by_method.find(row->method);
    if (rows == by_method.end() || rows->second.rig == nullptr)
      ++row->missing;
    else
      count_status(rows->second.rig->status, row);
  }
}

// Of what is stated of three figures.
double stated_length(const AxisFigures& figures, std::size_t first) {
  double squares = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) squares += std::pow(figures[i].value_or(0.0), 2);
  return std::sqrt(squares);
}

// Null where there is none.
const std::string* text_value(const Finding& finding, const char* name) {
  const FindingValue* value = finding.find(name);
  return value == nullptr ? nullptr : std::get_if<std::string>(&value->value);
}

// Of what somebody else says, which has no code of its own, the text.
std::string kind_of(const std::vector<Finding>& reasons) {
  std::string code = code_of(reasons);
  const std::string* text = code == "stated" ? text_value(reasons.front(), "text") : nullptr;
  return text == nullptr ? code : *text;
}

}  // namespace

std::string code_of(const std::vector<Finding>& reasons) {
  if (reasons.empty()) return "";
  const Finding& first = reasons.front();
  const std::string* beside = first.is("stated") ? text_value(first, "code") : nullptr;
  return beside == nullptr ? first.code : *beside;
}

std::optional<double> length_of(const AxisFigures& figures, std::size_t first) {
  double squares = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) {
    if (!figures[i]) return std::nullopt;
    squares += *figures[i] * *figures[i];
  }
  return std::sqrt(squares);
}

bool is_far(const SweepRow& row) {
  return stated_length(row.error, 0) > kFarCm || stated_length(row.error, 3) > kFarDeg;
}

std::string far_limits_in_words() { return plain_figure(0.01 * kFarCm) + " m or " + plain_figure(kFarDeg) + " deg"; }

const char* summary_axis_name(SummaryAxis axis) {
  static const std::array<const char*, kAxes> names = {"tx",   "ty",    "tz",  "rx",          "ry",      "rz",
                                                       "roll", "pitch", "yaw", "translation", "rotation"};
  return names[static_cast<std::size_t>(axis)];
}

const char* summary_axis_unit(SummaryAxis axis) {
  return axis == SummaryAxis::kTx || axis == SummaryAxis::kTy || axis == SummaryAxis::kTz ||
                 axis == SummaryAxis::kTranslation
             ? "cm"
             : "deg";
}

void FailureCounter::add(const std::string& method, SweepStatus status, const std::vector<Finding>& reasons) {
  if (status == SweepStatus::kSolved) return;
  FailureCount& failure = counts_[{method, status, kind_of(reasons)}];
  if (failure.tasks++ == 0) failure = {method, status, reasons, 1};
}

std::vector<FailureCount> FailureCounter::counts() const {
  std::vector<FailureCount> failures;
  for (const auto& [kind, failure] : counts_) failures.push_back(failure);
  std::stable_sort(failures.begin(), failures.end(),
                   [](const FailureCount& a, const FailureCount& b) { return a.tasks > b.tasks; });
  return failures;
}

std::vector<FailureCount> count_failures(const std::vector<SweepRow>& rows) {
  FailureCounter counter;
  for (const SweepRow& row : rows)
    if (row.subject == SweepSubject::kRig) counter.add(row.method, row.status, row.reasons);
  return counter.counts();
}

SweepSummary summarise(const SweepRows& table,
                       const std::function<std::vector<SweepRow>(std::size_t task, std::size_t method)>& rows_of) {
  SweepSummary summary;
  summary.name = table.name;
  summary.axes = table.axes;
  summary.methods = table.methods;
  summary.reference = table.reference;
  std::vector<std::vector<std::string>> points;
  std::map<std::vector<std::string>, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < table.tasks.size(); ++i) {
    const std::vector<std::string> point = point_of(table, table.tasks[i]);
    if (members[point].empty()) points.push_back(point);
    members[point].push_back(i);
  }
  std::uint64_t stream = 0;
  for (const std::vector<std::string>& point : points) {
    const PointRows rows(table, members[point], rows_of);
    for (const SweepSubject subject : {SweepSubject::kCamera, SweepSubject::kPair}) {
      for (int axis = 0; axis < kAxes; ++axis) {
        const Cell cell(table, rows.tasks(), subject, static_cast<SummaryAxis>(axis));
        for (const std::string& method : table.methods) {
          SummaryRow row = cell.row_of(method, stream++);
          row.levels = point;
          add_status(rows.tasks(), &row);
          summary.rows.push_back(std::move(row));
        }
      }
    }
  }
  correct_for_number_of_tests(&summary);
  return summary;
}

SweepSummary summarise(const SweepRows& table) {
  std::map<std::pair<std::string, std::string>, std::vector<const SweepRow*>> found;
  for (const SweepRow& row : table.rows) {
    std::vector<const SweepRow*>& rows = found[{row.task, row.method}];
    const auto same = [&row](const SweepRow* other) {
      return other->subject == row.subject && other->camera == row.camera;
    };
    // A task that stands in the list twice has its rows twice.
    if (std::none_of(rows.begin(), rows.end(), same)) rows.push_back(&row);
  }
  SweepSummary summary = summarise(table, [&](std::size_t task, std::size_t method) {
    std::vector<SweepRow> rows;
    for (const SweepRow* row : found[{table.tasks[task].key, table.methods[method]}]) rows.push_back(*row);
    return rows;
  });
  summary.failures = count_failures(table.rows);
  return summary;
}

}  // namespace rigproof
