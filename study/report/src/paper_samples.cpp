#include "paper_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/study/report/paper.h"

namespace rigproof::paper {
namespace {

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return std::nullopt;
  return *a - *b;
}

bool states_anything(const AxisFigures& figures) {
  return std::any_of(figures.begin(), figures.end(), [](const auto& figure) { return figure.has_value(); });
}

}  // namespace

AxisFigures paper_error(const SweepRow& row) {
  return {row.error[0],          row.error[1],          row.error[2],
          row.roll_pitch_yaw[0], row.roll_pitch_yaw[1], row.roll_pitch_yaw[2]};
}

std::string limits_in_words() {
  return "within " + plain_figure(0.01 * kFarCm) + " m and " + plain_figure(kFarDeg) + " deg";
}

const char* subject_title(SweepSubject subject) {
  return subject == SweepSubject::kCamera ? "camera to robot" : "camera to camera";
}

const PublishedTable& published_table(SweepSubject subject, bool synthetic) {
  for (const PublishedTable& table : published_tables())
    if (table.between_cameras == (subject == SweepSubject::kPair) && table.synthetic == synthetic) return table;
  throw Error("there is no such published table");
}

const PublishedRow* published_row(const PublishedTable& table, const std::string& method) {
  const std::string name = published_name_of(method);
  for (const PublishedRow& row : table.rows)
    if (row.method == name) return &row;
  return nullptr;
}

bool meets(const SweepRow& row, const Condition& condition) {
  return std::all_of(condition.begin(), condition.end(),
                     [&](const auto& wanted) { return row.levels.at(wanted.first) == wanted.second; });
}

std::optional<std::size_t> axis_of(const SweepRows& rows, const std::string& name) {
  const auto found = std::find(rows.axes.begin(), rows.axes.end(), name);
  if (found == rows.axes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - rows.axes.begin());
}

std::vector<NamedCondition> conditions_along(const SweepRows& rows, const std::string& name) {
  const std::optional<std::size_t> axis = axis_of(rows, name);
  if (!axis) return {NamedCondition()};
  std::vector<NamedCondition> conditions;
  for (const std::string& level : rows.levels[*axis]) conditions.push_back({level, {{*axis, level}}});
  return conditions;
}

std::optional<double> Sample::mean_absolute(std::size_t axis) const { return mean(absolute(values[axis])); }

Sample sample_of(const SweepRows& rows, const Condition& condition, const std::string& method, SweepSubject subject) {
  Sample sample;
  std::map<std::string, std::array<int, 6>> stated;  // rows of a task that state an axis
  std::map<std::string, int> wanted;                 // rows of a task
  for (const SweepRow& row : rows.rows) {
    if (row.method != method || !meets(row, condition)) continue;
    sample.tasks += row.subject == SweepSubject::kRig;
    if (row.subject != subject) continue;
    const AxisFigures error = paper_error(row);
    std::array<int, 6>& counts = stated[row.task];
    ++wanted[row.task];
    sample.answers += states_anything(error);
    for (std::size_t i = 0; i < 6; ++i) sample.stated[i] += error[i].has_value();
    if (is_far(row)) {
      ++sample.far;
      continue;
    }
    for (std::size_t i = 0; i < 6; ++i) {
      if (!error[i]) continue;
      sample.values[i].push_back(*error[i]);
      ++counts[i];
    }
    if (const auto length = length_of(error, 0)) sample.lengths_cm.push_back(*length);
    if (const auto angle = length_of(error, 3)) sample.angles_deg.push_back(*angle);
  }
  for (const auto& [task, counts] : stated) {
    bool all = sample.answers > sample.far;
    for (std::size_t i = 0; i < 6; ++i) all = all && (sample.values[i].empty() || counts[i] == wanted[task]);
    sample.success += all;
  }
  return sample;
}

std::optional<double> mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::optional<double> deviation(const std::vector<double>& values) {
  if (values.size() < 2) return std::nullopt;
  const double middle = *mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - middle) * (value - middle);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

std::vector<double> absolute(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return values;
}

SweepRows against_method(const SweepRows& rows, const std::string& method) {
  std::map<std::pair<std::string, std::string>, const SweepRow*> references;
  for (const SweepRow& row : rows.rows)
    if (row.method == method && row.subject == SweepSubject::kPair) references[{row.task, row.camera}] = &row;
  SweepRows result = rows;
  result.rows.clear();
  for (SweepRow row : rows.rows) {
    if (row.method == method || row.subject == SweepSubject::kCamera) continue;
    if (row.subject == SweepSubject::kPair) {
      const auto reference = references.find({row.task, row.camera});
      if (reference == references.end() || !reference->second->error[0]) continue;
      for (std::size_t i = 0; i < 6; ++i) row.error[i] = difference(row.error[i], reference->second->error[i]);
      for (std::size_t i = 0; i < 3; ++i)
        row.roll_pitch_yaw[i] = difference(row.roll_pitch_yaw[i], reference->second->roll_pitch_yaw[i]);
    }
    result.rows.push_back(row);
  }
  result.methods.erase(std::remove(result.methods.begin(), result.methods.end(), method), result.methods.end());
  return result;
}

}  // namespace rigproof::paper
