// The tables of a sweep's folder: rows.csv, rows.jsonl, times.csv, and the summary's files.
#include <map>
#include <nlohmann/json.hpp>

#include "answer_store.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/growing_file.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/sweep/table_text.h"
#include "rigproof/words/sentences.h"

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
  text("reason", words::text_of(row.reasons));
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
  text("code", code_of(row.reasons));
  number("motions", row.motions ? std::optional<double>(*row.motions) : std::nullopt);
}

std::string csv_header(const SweepRows& table) {
  std::string text = "task";
  for (const std::string& axis : table.axes) text += "," + csv_cell(axis);
  visit_columns(
      SweepRow(), [&text](const std::string& name, const std::string&) { text += "," + name; },
      [&text](const std::string& name, const std::optional<double>&) { text += "," + name; });
  return text + "\n";
}

std::string csv_line(const SweepRow& row) {
  std::string text = row.task;
  for (const std::string& level : row.levels) text += "," + csv_cell(level);
  visit_columns(
      row, [&text](const std::string&, const std::string& value) { text += "," + csv_cell(value); },
      [&text](const std::string&, const std::optional<double>& value) { text += "," + csv_cell(value); });
  return text + "\n";
}

std::string json_line(const SweepRows& table, const SweepRow& row) {
  ordered_json object;
  object["task"] = row.task;
  object["levels"] = ordered_json::object();
  for (std::size_t i = 0; i < row.levels.size(); ++i) object["levels"][table.axes[i]] = row.levels[i];
  visit_columns(
      row, [&object](const std::string& name, const std::string& value) { object[name] = value; },
      [&object](const std::string& name, const std::optional<double>& value) {
        object[name] = value ? ordered_json(*value) : ordered_json(nullptr);
      });
  object["seed"] = row.seed;
  return object.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::vector<std::string> labels_of(const SweepRows& table, const SweepTask& task) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < task.levels.size(); ++i) labels.push_back(table.levels[i][task.levels[i]]);
  return labels;
}

// With what the task says of itself.
std::vector<SweepRow> rows_of(const SweepRows& table, const SweepTask& task, std::size_t method, SweepAnswer answer) {
  for (SweepRow& row : answer.rows) {
    row.task = task.key;
    row.levels = labels_of(table, task);
    row.seed = task.seed;
    row.method = table.methods[method];
  }
  return std::move(answer.rows);
}

std::string times_header(const SweepRows& table) {
  std::string text = "task";
  for (const std::string& axis : table.axes) text += "," + csv_cell(axis);
  return text + ",seed,method,solve_s,cpu_s,observe_s,host,cpu,gl_renderer\n";
}

std::string times_line(const SweepRows& table, const SweepTask& task, std::size_t method, const SweepAnswer& answer) {
  std::string text = task.key;
  for (const std::string& label : labels_of(table, task)) text += "," + csv_cell(label);
  text += "," + std::to_string(task.seed) + "," + csv_cell(table.methods[method]);
  for (const double value : {answer.times.solve_s, answer.times.cpu_s, answer.times.observe_s})
    text += "," + fixed_text(value, 4);
  for (const std::string& name : {answer.machine.host, answer.machine.cpu, answer.machine.gl_renderer})
    text += "," + csv_cell(name);
  return text + "\n";
}

// "lambda 0, seed 3, task 0123456789abcdef: ml".
std::string name_of(const SweepRows& table, const SweepTask& task, std::size_t method) {
  std::string text;
  for (std::size_t i = 0; i < task.levels.size(); ++i)
    text += table.axes[i] + " " + table.levels[i][task.levels[i]] + ", ";
  return text + "seed " + std::to_string(task.seed) + ", task " + task.key + ": " + table.methods[method];
}

std::vector<SweepMachineCount> counted(const std::map<SweepMachine, std::size_t>& machines) {
  std::vector<SweepMachineCount> counts;
  for (const auto& [machine, answers] : machines) counts.push_back({machine, answers});
  return counts;
}

// One answer is in memory at a time.
SweepTables write_rows(const std::filesystem::path& folder, const SweepRows& table, const AnswerStore& store) {
  GrowingFile csv(folder / "rows.csv"), lines(folder / "rows.jsonl"), times(folder / "times.csv");
  csv.append(csv_header(table));
  times.append(times_header(table));
  SweepTables tables;
  FailureCounter failures;
  std::map<SweepMachine, std::size_t> machines;
  for (const SweepTask& task : table.tasks) {
    for (std::size_t method = 0; method < table.methods.size(); ++method) {
      std::optional<SweepAnswer> answer = store.load(task.key, method);
      if (!answer) {
        tables.missing.push_back(name_of(table, task, method));
        continue;
      }
      times.append(times_line(table, task, method, *answer));
      ++machines[answer->machine];
      const SweepRow& rig = answer->rows.front();
      failures.add(table.methods[method], rig.status, rig.reasons);
      for (const SweepRow& row : rows_of(table, task, method, std::move(*answer))) {
        csv.append(csv_line(row));
        lines.append(json_line(table, row));
      }
    }
  }
  for (GrowingFile* file : {&csv, &lines, &times}) file->finish();
  tables.machines = counted(machines);
  tables.summary.failures = failures.counts();
  return tables;
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
  const SweepPlan plan = load_folder_plan({folder});
  const AnswerStore store({folder}, plan);
  SweepRows rows = plan.table;
  std::map<SweepMachine, std::size_t> machines;
  for (const SweepTask& task : plan.table.tasks) {
    for (std::size_t method = 0; method < rows.methods.size(); ++method) {
      std::optional<SweepAnswer> answer = store.load(task.key, method);
      if (!answer) continue;
      ++machines[answer->machine];
      for (SweepRow& row : rows_of(plan.table, task, method, std::move(*answer))) rows.rows.push_back(std::move(row));
    }
  }
  rows.machines = counted(machines);
  return rows;
}

SweepTables gather_sweep(const std::filesystem::path& folder) {
  const SweepPlan plan = load_folder_plan({folder});
  const SweepRows& table = plan.table;
  const AnswerStore store({folder}, plan);
  SweepTables tables = write_rows(folder, table, store);
  SweepSummary summary = summarise(table, [&](std::size_t task, std::size_t method) {
    std::optional<SweepAnswer> answer = store.load(table.tasks[task].key, method);
    return answer ? rows_of(table, table.tasks[task], method, std::move(*answer)) : std::vector<SweepRow>();
  });
  summary.failures = std::move(tables.summary.failures);
  tables.summary = std::move(summary);
  write_file_atomically(folder / "summary.csv", summary_as_csv(tables.summary));
  write_file_atomically(folder / "summary.json", summary_as_json(tables.summary));
  write_file_atomically(folder / "summary.md", summary_as_markdown(tables.summary));
  return tables;
}

SweepState sweep_state(const std::filesystem::path& folder) {
  const SweepPlan plan = load_folder_plan({folder});
  const AnswerStore store({folder}, plan);
  const std::vector<std::string>& methods = plan.table.methods;
  SweepState state;
  state.name = plan.table.name;
  state.tasks = plan.table.tasks.size();
  state.answers = state.tasks * methods.size();
  FailureCounter failures;
  std::map<SweepMachine, std::size_t> machines;
  for (const SweepTask& task : plan.table.tasks) {
    for (std::size_t method = 0; method < methods.size(); ++method) {
      const std::optional<AnswerBrief> brief = store.brief(task.key, method);
      if (!brief) continue;
      ++state.answers_there;
      ++machines[brief->machine];
      failures.add(methods[method], brief->status, brief->reasons);
    }
  }
  state.running = FolderLock::is_held(folder);
  state.failures = failures.counts();
  state.machines = counted(machines);
  state.counters = load_counters({folder});
  return state;
}

std::optional<SweepState> sweep_state_unless_gone(const std::filesystem::path& folder) {
  const auto is_there = [plan = SweepFolder{folder}.plan_file()] {
    std::error_code ignored;
    return std::filesystem::is_regular_file(plan, ignored);
  };
  try {
    SweepState state = sweep_state(folder);
    // It may have gone while its answers were counted.
    return is_there() ? std::optional<SweepState>(std::move(state)) : std::nullopt;
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain || !is_there()) return std::nullopt;
    throw;
  }
}

std::map<std::string, std::size_t> answers_by_renderer(const std::vector<SweepMachineCount>& machines) {
  std::map<std::string, std::size_t> answers;
  for (const SweepMachineCount& entry : machines)
    if (!entry.machine.gl_renderer.empty()) answers[entry.machine.gl_renderer] += entry.answers;
  return answers;
}

bool has_mixed_renderers(const std::vector<SweepMachineCount>& machines) {
  return answers_by_renderer(machines).size() > 1;
}

std::filesystem::path sweep_config_file(const std::filesystem::path& file_or_folder) {
  if (!std::filesystem::is_directory(file_or_folder)) return file_or_folder;
  const SweepFolder folder{file_or_folder};
  if (!std::filesystem::is_regular_file(folder.config_file()))
    throw Error(file_or_folder.string() + ": holds no sweep.yaml: give a sweep's configuration, or its folder");
  // What is written there says something; a file that lost its content would be a sweep of one default run.
  if (read_yaml_file(folder.config_file()).is_null())
    throw Error(folder.config_file().string() +
                ": is empty, so it is damaged: give the configuration that it was made of, and -o with its folder");
  return folder.config_file();
}

}  // namespace rigproof
