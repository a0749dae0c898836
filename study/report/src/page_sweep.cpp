#include <algorithm>
#include <map>

#include "page_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/words/sentences.h"

namespace rigproof::page_detail {
namespace {

// Numbers each name in the order in which they come.
class Names {
 public:
  int number_of(const std::string& name) {
    const auto [entry, is_new] = numbers_.try_emplace(name, static_cast<int>(names_.size()));
    if (is_new) names_.push_back(name);
    return entry->second;
  }
  const std::vector<std::string>& all() const { return names_; }

 private:
  std::map<std::string, int> numbers_;
  std::vector<std::string> names_;
};

Json short_number(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return parse_number(short_text(*value, 3)).value_or(*value);
}

Json axes_json(const SweepRows& rows) {
  Json axes = Json::array();
  for (std::size_t i = 0; i < rows.axes.size(); ++i)
    axes.push_back({{"name", rows.axes[i]},
                    {"title", rows.axis_titles[i]},
                    {"pooled", static_cast<bool>(rows.pooled[i])},
                    {"levels", rows.levels[i]},
                    {"values", rows.level_values[i]}});
  return axes;
}

// {"runs": [value, count, ..]}, where that is shorter.
Json in_runs(Json column) {
  Json runs = Json::array();
  for (const Json& value : column) {
    if (!runs.empty() && runs[runs.size() - 2] == value)
      runs.back() = runs.back().get<std::size_t>() + 1;
    else
      runs.insert(runs.end(), {value, 1});
  }
  if (runs.size() >= column.size()) return column;
  return {{"runs", std::move(runs)}};
}

// Columns, so that names of columns are written once. The levels of a task are told with the task.
Json rows_json(const SweepRows& rows, Names* subjects, Names* statuses) {
  std::map<std::string, std::size_t> tasks, methods;
  for (std::size_t i = 0; i < rows.tasks.size(); ++i) tasks[rows.tasks[i].key] = i;
  for (std::size_t i = 0; i < rows.methods.size(); ++i) methods[rows.methods[i]] = i;
  Json task = Json::array(), method = Json::array(), subject = Json::array(), status = Json::array();
  Json errors = Json::array(), sigmas = Json::array(), nees = Json::array();
  Json nees_dof = Json::array();
  for (const SweepRow& row : rows.rows) {
    const auto found = tasks.find(row.task);
    const auto by = methods.find(row.method);
    if (found == tasks.end() || by == methods.end()) continue;
    task.push_back(found->second);
    method.push_back(by->second);
    subject.push_back(subjects->number_of(std::string(sweep_subject_name(row.subject)) + ":" + row.camera));
    status.push_back(statuses->number_of(sweep_status_name(row.status)));
    nees.push_back(short_number(row.nees));
    nees_dof.push_back(row.nees_degrees_of_freedom);
    const bool is_empty = std::none_of(row.error.begin(), row.error.end(), [](const auto& e) { return e.has_value(); });
    Json error = nullptr, sigma = nullptr;
    for (std::size_t axis = 0; axis < 6 && !is_empty; ++axis) {
      error.push_back(short_number(row.error[axis]));
      sigma.push_back(short_number(row.sigma[axis]));
    }
    errors.push_back(std::move(error));
    sigmas.push_back(std::move(sigma));
  }
  return {{"task", in_runs(std::move(task))}, {"method", in_runs(std::move(method))},
          {"subject", std::move(subject)},    {"status", in_runs(std::move(status))},
          {"error", std::move(errors)},       {"sigma", std::move(sigmas)},
          {"nees", in_runs(std::move(nees))}, {"nees_dof", in_runs(std::move(nees_dof))}};
}

Json tasks_json(const SweepRows& rows) {
  Json tasks = Json::array();
  for (const SweepTask& task : rows.tasks) {
    Json levels = task.levels;
    levels.push_back(task.seed);
    tasks.push_back(std::move(levels));
  }
  return tasks;
}

Json failures_json(const SweepRows& rows) {
  Json list = Json::array();
  for (const FailureCount& failure : count_failures(rows.rows))
    list.push_back({{"method", failure.method},
                    {"status", sweep_status_name(failure.status)},
                    {"code", code_of(failure.reasons)},
                    {"reason", words::text_of(failure.reasons)},
                    {"tasks", failure.tasks}});
  return list;
}

// Of more than one the pictures differ.
Json renderers_json(const SweepRows& rows) {
  Json list = Json::array();
  for (const auto& [name, answers] : answers_by_renderer(rows.machines))
    list.push_back({{"name", name}, {"answers", answers}});
  return list;
}

}  // namespace
}  // namespace rigproof::page_detail

namespace rigproof {

PageContent sweep_page_content(const SweepRows& rows) {
  using namespace page_detail;
  if (rows.rows.empty()) throw Error("the sweep has no answer to report; make some with: rigproof sweep start");
  Names subjects, statuses;
  Json data = {{"kind", "sweep"}, {"version", version()}, {"title", rows.name}, {"reference", rows.reference}};
  data["axes"] = axes_json(rows);
  data["methods"] = rows.methods;
  data["tasks"] = tasks_json(rows);
  data["rows"] = rows_json(rows, &subjects, &statuses);
  data["subjects"] = subjects.all();
  data["statuses"] = statuses.all();
  data["failures"] = failures_json(rows);
  data["gl_renderers"] = renderers_json(rows);
  return {rows.name, text_of(data), "[]"};
}

}  // namespace rigproof
