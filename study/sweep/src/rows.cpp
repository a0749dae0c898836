// The tables of a sweep's folder: rows.csv, rows.jsonl, times.csv, and the summary's files.
#include <nlohmann/json.hpp>

#include "folder.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/text.h"
#include "rigproof/study/sweep/table_text.h"

namespace rigproof {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

const std::array<const char*, 6> kUnits = {"_cm", "_cm", "_cm", "_deg", "_deg", "_deg"};
const std::array<const char*, 3> kAngles = {"roll_deg", "pitch_deg", "yaw_deg"};

// Calls back with every column of a row behind the axes, by name.
template <typename Number, typename Text>
void visit_columns(const SweepRow& row, const Text& text, const Number& number) {
  text("seed", std::to_string(row.seed));
  text("method", row.method);
  text("subject", sweep_subject_name(row.subject));
  text("camera", row.camera);
  text("status", sweep_status_name(row.status));
  text("reason", row.reason);
  const auto axes = [&](const std::string& prefix, const auto& value, bool with_unit) {
    for (std::size_t i = 0; i < 6; ++i)
      number(prefix + kDegreeOfFreedomNames[i] + (with_unit ? kUnits[i] : ""), value(i));
  };
  axes(
      "", [&row](std::size_t i) { return row.error[i]; }, true);
  for (std::size_t i = 0; i < 3; ++i) number(kAngles[i], row.roll_pitch_yaw[i]);
  axes(
      "sigma_", [&row](std::size_t i) { return row.sigma[i]; }, true);
  axes(
      "z_", [&row](std::size_t i) { return row.z(i); }, false);
  axes(
      "bound_", [&row](std::size_t i) { return row.bound[i]; }, true);
  number("nees", row.nees);
  number("nees_dof", row.nees ? std::optional<double>(row.nees_degrees_of_freedom) : std::nullopt);
  text("code", row.code);
}

std::string rows_as_csv(const SweepRows& rows) {
  std::string text = "task";
  for (const std::string& axis : rows.axes) text += "," + csv_cell(axis);
  visit_columns(
      SweepRow(), [&text](const std::string& name, const std::string&) { text += "," + name; },
      [&text](const std::string& name, const std::optional<double>&) { text += "," + name; });
  text += "\n";
  for (const SweepRow& row : rows.rows) {
    text += row.task;
    for (const std::string& level : row.levels) text += "," + csv_cell(level);
    visit_columns(
        row, [&text](const std::string&, const std::string& value) { text += "," + csv_cell(value); },
        [&text](const std::string&, const std::optional<double>& value) { text += "," + csv_cell(value); });
    text += "\n";
  }
  return text;
}

std::string rows_as_json_lines(const SweepRows& rows) {
  std::string text;
  for (const SweepRow& row : rows.rows) {
    ordered_json object;
    object["task"] = row.task;
    object["levels"] = ordered_json::object();
    for (std::size_t i = 0; i < row.levels.size(); ++i) object["levels"][rows.axes[i]] = row.levels[i];
    visit_columns(
        row, [&object](const std::string& name, const std::string& value) { object[name] = value; },
        [&object](const std::string& name, const std::optional<double>& value) {
          object[name] = value ? ordered_json(*value) : ordered_json(nullptr);
        });
    object["seed"] = row.seed;
    text += object.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }
  return text;
}

// Every finished answer, in the order of tasks and methods.
template <typename Take>
void for_each_answer(const SweepFolder& folder, const SweepRows& table, const Take& take) {
  for (const SweepTaskName& task : table.tasks)
    for (const std::string& method : table.methods)
      if (std::optional<SweepAnswer> answer = load_answer(folder, task.key, method)) take(task, method, *answer);
}

std::vector<std::string> labels_of(const SweepRows& table, const SweepTaskName& task) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < task.levels.size(); ++i) labels.push_back(table.levels[i][task.levels[i]]);
  return labels;
}

void append(const SweepTaskName& task, const std::string& method, const SweepAnswer& answer, SweepRows* rows) {
  for (SweepRow row : answer.rows) {
    row.task = task.key;
    row.levels = labels_of(*rows, task);
    row.seed = task.seed;
    row.method = method;
    rows->rows.push_back(std::move(row));
  }
}

}  // namespace

const char* sweep_status_name(SweepStatus status) {
  static constexpr std::array<const char*, 6> kNames = {"solved",  "partial",       "not_given",
                                                        "refused", "could_not_run", "failed"};
  return kNames[static_cast<std::size_t>(status)];
}

const char* sweep_subject_name(SweepSubject subject) {
  static constexpr std::array<const char*, 3> kNames = {"rig", "camera", "pair"};
  return kNames[static_cast<std::size_t>(subject)];
}

std::optional<double> SweepRow::z(std::size_t axis) const {
  if (!error[axis] || !sigma[axis] || !(*sigma[axis] > 0.0)) return std::nullopt;
  return *error[axis] / *sigma[axis];
}

SweepRows load_sweep_rows(const std::filesystem::path& folder) {
  const SweepFolder sweep{folder};
  SweepRows rows = load_folder_plan(sweep).table;
  const SweepRows table = rows;
  for_each_answer(sweep, table,
                  [&rows](const SweepTaskName& task, const std::string& method, const SweepAnswer& answer) {
                    append(task, method, answer, &rows);
                  });
  return rows;
}

SweepSummary gather_sweep(const std::filesystem::path& folder) {
  const SweepFolder sweep{folder};
  SweepRows rows = load_folder_plan(sweep).table;
  const SweepRows table = rows;
  std::string times = "task";
  for (const std::string& axis : table.axes) times += "," + csv_cell(axis);
  times += ",seed,method,solve_s,cpu_s,observe_s\n";
  for_each_answer(sweep, table, [&](const SweepTaskName& task, const std::string& method, const SweepAnswer& answer) {
    append(task, method, answer, &rows);
    times += task.key;
    for (const std::string& label : labels_of(table, task)) times += "," + csv_cell(label);
    times += "," + std::to_string(task.seed) + "," + csv_cell(method);
    for (const double value : {answer.times.solve_s, answer.times.cpu_s, answer.times.observe_s})
      times += "," + fixed_text(value, 4);
    times += "\n";
  });
  write_file_atomically(folder / "rows.csv", rows_as_csv(rows));
  write_file_atomically(folder / "rows.jsonl", rows_as_json_lines(rows));
  write_file_atomically(folder / "times.csv", times);
  SweepSummary summary = summarise(rows);
  write_file_atomically(folder / "summary.csv", summary_as_csv(summary));
  write_file_atomically(folder / "summary.json", summary_as_json(summary));
  write_file_atomically(folder / "summary.md", summary_as_markdown(summary));
  return summary;
}

SweepState sweep_state(const std::filesystem::path& folder) {
  const SweepRows rows = load_sweep_rows(folder);
  SweepState state;
  state.name = rows.name;
  state.tasks = rows.tasks.size();
  state.answers = rows.tasks.size() * rows.methods.size();
  for (const SweepRow& row : rows.rows) state.answers_there += row.subject == SweepSubject::kRig ? 1 : 0;
  state.running = FolderLock::is_held(folder);
  state.failures = count_failures(rows.rows);
  state.counters = load_counters({folder});
  return state;
}

std::filesystem::path sweep_config_file(const std::filesystem::path& file_or_folder) {
  if (!std::filesystem::is_directory(file_or_folder)) return file_or_folder;
  const SweepFolder folder{file_or_folder};
  if (std::filesystem::is_regular_file(folder.config_file())) return folder.config_file();
  throw Error(file_or_folder.string() + ": holds no sweep.yaml: give a sweep's configuration, or its folder");
}

}  // namespace rigproof
