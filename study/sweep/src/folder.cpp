#include "folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "rigproof-sweep-plan 1";
constexpr const char* kDigits = "0123456789abcdef";
constexpr std::uintmax_t kMaxPlanBytes = 512U << 20U;

// Everything but the tasks, by name.
template <typename Table, typename Visit>
void visit_fields(Table& table, const Visit& visit) {
  visit("name", table.name);
  visit("axes", table.axes);
  visit("axis_titles", table.axis_titles);
  visit("pooled", table.pooled);
  visit("levels", table.levels);
  visit("level_values", table.level_values);
  visit("methods", table.methods);
  visit("reference", table.reference);
}

json json_of(const SweepRows& table) {
  json object = {{"tasks", json::array()}};
  visit_fields(table, [&object](const char* name, const auto& value) { object[name] = value; });
  for (const SweepTask& task : table.tasks) {
    json& entry = object["tasks"].emplace_back(json{task.key, task.levels, task.seed});
    if (!task.pictures.empty()) entry.push_back(task.pictures);
  }
  return object;
}

SweepRows table_of(const json& object) {
  SweepRows table;
  visit_fields(table, [&object](const char* name, auto& value) { object.at(name).get_to(value); });
  for (const json& entry : object.at("tasks"))
    table.tasks.push_back({entry.at(0).get<std::string>(), entry.at(1).get<std::vector<std::size_t>>(),
                           entry.at(2).get<std::int64_t>(),
                           entry.size() > 3 ? entry.at(3).get<std::string>() : std::string()});
  return table;
}

// Every index must be one, so that nobody after this has to look.
bool is_sound(const SweepRows& table) {
  const std::size_t axes = table.axes.size();
  if (table.axis_titles.size() != axes || table.pooled.size() != axes || table.levels.size() != axes ||
      table.level_values.size() != axes)
    return false;
  for (std::size_t i = 0; i < axes; ++i)
    if (table.level_values[i].size() != table.levels[i].size()) return false;
  return std::all_of(table.tasks.begin(), table.tasks.end(), [&](const SweepTask& task) {
    if (task.levels.size() != axes || (task.key + task.pictures).find_first_not_of(kDigits) != std::string::npos)
      return false;
    for (std::size_t i = 0; i < axes; ++i)
      if (task.levels[i] >= table.levels[i].size()) return false;
    return true;
  });
}

// A share may not be mounted yet on a node that has just come up, or be gone for a while; a folder without a plan stays
// without one.
void require_root(const SweepFolder& folder) {
  if (folder.root.empty()) throw Error("sweep: the folder's name is empty");
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::status(folder.root, error))) return;
  if (error == std::errc::no_such_file_or_directory)
    throw Error(folder.root.string() + ": is not there; once its share is mounted the same command goes on, or " +
                    "`rigproof sweep plan CONFIG -o " + folder.root.string() + "` makes it",
                ExitCode::kTryAgain);
  throw_system_error(folder.root, "look at the folder", error.value());
}

}  // namespace

SweepPlan sweep_plan_of(const SweepConfig& config, std::vector<SweepTask> tasks,
                        const std::vector<SweepMethod>& methods, std::vector<std::string> added) {
  SweepPlan plan;
  plan.added = std::move(added);
  SweepRows& table = plan.table;
  table.name = config.name;
  for (const SweepAxis& axis : config.axes) {
    table.axes.push_back(axis.name);
    table.axis_titles.push_back(axis.title.empty() ? axis.name : axis.title);
    table.pooled.push_back(axis.pooled);
    std::vector<std::string>& labels = table.levels.emplace_back();
    std::vector<double>& values = table.level_values.emplace_back();
    for (const SweepLevel& level : axis.levels) {
      labels.push_back(level.label);
      values.push_back(level.value);
    }
  }
  for (const SweepMethod& method : methods) {
    table.methods.push_back(method.name);
    plan.hashes.push_back(method.hash);
  }
  for (std::size_t i = 0; i < config.methods.size(); ++i)
    if (config.methods[i].label() == config.reference) table.reference = methods[i].name;
  table.tasks = std::move(tasks);
  return plan;
}

void save_folder_plan(const SweepFolder& folder, const SweepPlan& plan) {
  const json object = {
      {"format", kFormat}, {"added", plan.added}, {"hashes", plan.hashes}, {"table", json_of(plan.table)}};
  write_file_atomically(folder.plan_file(), object.dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
}

SweepPlan load_folder_plan(const SweepFolder& folder) {
  require_root(folder);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder.plan_file(), ignored))
    throw Error(folder.root.string() + ": holds no sweep; `rigproof sweep start CONFIG -o " + folder.root.string() +
                "` makes one");
  try {
    const json object = json::parse(read_text_file(folder.plan_file(), kMaxPlanBytes));
    SweepPlan plan;
    if (object.at("format") == kFormat) {
      object.at("added").get_to(plan.added);
      plan.table = table_of(object.at("table"));
      plan.hashes = object.value("hashes", std::vector<std::string>(plan.table.methods.size()));
      if (is_sound(plan.table) && plan.hashes.size() == plan.table.methods.size()) return plan;
    }
  } catch (const json::exception&) {
    // told below
  }
  throw Error(folder.plan_file().string() +
              ": is damaged; `rigproof sweep start` with its configuration writes it anew");
}

std::optional<SweepAnswer> load_answer(const SweepFolder& folder, const SweepPlan& plan, const std::string& task,
                                       std::size_t method) {
  const std::filesystem::path file = folder.answer_file(task, plan.table.methods[method]);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  try {
    std::optional<SweepAnswer> answer = read_answer(read_text_file(file));
    const std::string& hash = plan.hashes[method];
    return answer && (hash.empty() || answer->method_hash == hash) ? answer : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;  // another process has just packed it
  }
}

void save_counters(const SweepFolder& folder, const SweepCounters& this_start, const SweepCounters& all_starts) {
  const json object = {{"this_start", this_start}, {"all_starts", all_starts}};
  write_file_atomically(folder.counters_file(), object.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

SweepCounters load_counters(const SweepFolder& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder.counters_file(), ignored)) return {};
  try {
    return json::parse(read_text_file(folder.counters_file())).at("all_starts").get<SweepCounters>();
  } catch (const json::exception&) {
    return {};
  }
}

}  // namespace rigproof
