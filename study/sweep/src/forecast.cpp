// What a start would do and about how long it would take on one core. Measured where the estimates are checked:
// docs/guides/sweeps.md.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "rigproof/generator/generate.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/words/sentences.h"
#include "stock.h"

namespace rigproof {
namespace {

constexpr double kOutside_s = 1.0;                           // a program of somebody else's that was not timed yet
constexpr std::size_t kTimedAnswers = 100;                   // of a program: more say no more
constexpr double kProcess_s = 0.005, kObserve_s = 8e-5;      // a task, a view
constexpr double kSearchStart_s = 0.012, kSearch_s = 0.045;  // an image, a megapixel: to find board and planes
constexpr double kMatching_s = 0.35;                         // a megapixel: to match an image with the next one
constexpr double kChessboard_s = 0.05;                       // a megapixel: to search it with OpenCV

// Images of stops (stops times cameras) that a task's methods are given. `rigs` keeps the cameras of rigs whose file
// was read.
double views_of(const TaskSettings& task, bool rendered, std::map<std::string, double>* rigs) {
  constexpr double kReferenceCameras = 3.0;
  const auto stops = static_cast<double>(task.images > 0 ? task.images : task.config.poses);
  if (!rendered && task.geometric.rig != "run")
    return stops * (task.geometric.rig == "random" ? static_cast<double>(task.geometric.cameras) : kReferenceCameras);
  const auto [cameras, is_new] = rigs->emplace(task.config.rig, 0.0);
  if (is_new) cameras->second = static_cast<double>(load_rig_model(task.config.rig).rig.cameras.size());
  return stops * cameras->second;
}

// Of an image of the run, the mean of its cameras.
double megapixels_of(const GenerateConfig& config) {
  const std::vector<RigCamera> cameras = load_rig_model(config.rig).rig.cameras;
  double pixels = 0.0;
  for (const RigCamera& camera : cameras) pixels += 1.0 * camera.camera.width_px * camera.camera.height_px;
  return 1e-6 * pixels / static_cast<double>(cameras.size()) * config.image_scale * config.image_scale;
}

std::string line_of(const SweepStart& start, const SweepTask& task, const std::map<std::string, std::size_t>& left) {
  std::string line;
  for (std::size_t i = 0; i < task.levels.size(); ++i)
    line += start.config.axes[i].name + " " + start.config.axes[i].levels[task.levels[i]].label + ", ";
  const auto found = left.find(task.key);
  const std::size_t there = start.methods.size() - (found == left.end() ? 0 : found->second);
  return line + "seed " + std::to_string(task.seed) + ": " + std::to_string(there) + " of " +
         std::to_string(start.methods.size()) + " answers there";
}

std::vector<std::string> those_that_cannot_run(const std::vector<SweepMethod>& methods) {
  std::vector<std::string> lines;
  for (const SweepMethod& method : methods) {
    if (!method.reads_images) continue;
    std::optional<Finding> why_not = methods_by_name({method.spec}).front()->why_not({Observations(), nullptr, 1});
    if (!why_not) why_not = why_no_ground(method.vision, false);
    if (why_not) lines.push_back(method.name + ": " + words::sentence_of(*why_not));
  }
  return lines;
}

// What a program from outside took for each of the answers that are there, on average; absent where there are none.
std::optional<double> timed_seconds(const SweepStart& start, const AnswerStore& store, std::size_t method) {
  double seconds = 0.0;
  std::size_t count = 0;
  for (const WorkItem& item : start.order) {
    const std::optional<SweepAnswer> answer = store.load(item.task->key, method);
    if (!answer) continue;
    seconds += answer->times.solve_s;
    if (++count == kTimedAnswers) break;
  }
  return count == 0 ? std::nullopt : std::optional<double>(seconds / static_cast<double>(count));
}

std::map<std::string, double> timed_methods(const SweepStart& start) {
  const AnswerStore store(start.folder, start.plan);
  std::map<std::string, double> seconds;
  for (std::size_t i = 0; i < start.methods.size(); ++i)
    if (start.methods[i].outside)
      if (const auto timed = timed_seconds(start, store, i)) seconds[start.methods[i].name] = *timed;
  return seconds;
}

// A task is one process's: of four processes, three wait for the fifth task as long as they worked. Above 1 by that.
double longer_by_whole_tasks(std::size_t tasks, std::size_t processes) {
  if (tasks == 0) return 1.0;
  const std::size_t rounds = (tasks + processes - 1) / processes;
  return static_cast<double>(rounds * processes) / static_cast<double>(tasks);
}

void add_answers(const SweepStart& start, const std::vector<PendingTask>& tasks, SweepForecast* forecast) {
  double seconds = 0.0;
  std::map<std::string, double> rigs;
  const std::map<std::string, double> timed = timed_methods(start);
  for (const PendingTask& pending : tasks) {
    const double views = views_of(settings_of(start.config, *pending.task), !pending.task->pictures.empty(), &rigs);
    seconds += kProcess_s + kObserve_s * views;
    for (const SweepMethod* method : pending.methods) {
      const auto known = timed.find(method->name);
      forecast->answers_not_timed += method->outside && known == timed.end() ? 1 : 0;
      seconds += !method->outside ? method->seconds_a_view * views : known == timed.end() ? kOutside_s : known->second;
    }
  }
  forecast->minutes += seconds * longer_by_whole_tasks(tasks.size(), start.processes()) / 60.0;
}

// By the first of the sets that are to be made.
void add_pictures(const SweepStart& start, const std::vector<const PictureSet*>& to_make, SweepForecast* forecast) {
  if (to_make.empty()) return;
  const GeneratePlan plan = plan_generation(to_make.front()->config);
  const double images = static_cast<double>(forecast->images_to_render);
  const double sets = images / static_cast<double>(plan.images);
  forecast->megabytes = sets * plan.expected_mb;
  const double cores = std::max(1U, std::thread::hardware_concurrency());
  const double megapixels = megapixels_of(to_make.front()->config);
  const auto any = [&start](const auto& is) { return std::any_of(start.methods.begin(), start.methods.end(), is); };
  const bool matches = any([](const SweepMethod& method) { return method.matches_features; });
  const bool searches = any([](const SweepMethod& method) { return method.reads_images && !method.matches_features; });
  const double megapixel_s = kSearch_s + (matches ? kMatching_s : 0.0) + (searches ? kChessboard_s : 0.0);
  const double look_s = kSearchStart_s + megapixel_s * megapixels;
  forecast->minutes += sets * plan.expected_minutes * cores + images * look_s / 60.0;
}

}  // namespace

SweepForecast forecast_sweep(const SweepConfig& config, const SweepOptions& options) {
  SweepStart start = start_of(config, options);
  plan_all(&start);
  const Stock stock = take_stock(start, true);
  SweepForecast forecast;
  const std::vector<SweepTask>& tasks = start.plan.table.tasks;
  forecast.tasks = tasks.size();
  forecast.points = config.seeds.empty() ? 0 : forecast.tasks / config.seeds.size();
  forecast.answers = stock.answers;
  forecast.answers_there = stock.answers_done;
  std::set<std::string> sets;
  for (const SweepTask& task : tasks)
    if (!task.pictures.empty()) sets.insert(task.pictures);
  forecast.picture_sets = sets.size();
  std::vector<const PictureSet*> to_make;
  for (const PendingPictures& set : stock.pictures) {
    if (set.state == PendingPictures::State::kReady || start.cache.has_pictures(set.set.key, true)) continue;
    to_make.push_back(&set.set);
    forecast.images_to_render += set.images;
  }
  forecast.picture_sets_there = forecast.picture_sets - to_make.size();
  std::map<std::string, std::size_t> left;
  for (const PendingTask& pending : stock.tasks) left[pending.task->key] = pending.methods.size();
  for (const SweepTask& task : tasks) forecast.task_lines.push_back(line_of(start, task, left));
  if (config.geometric) forecast.cannot_run = those_that_cannot_run(start.methods);
  add_answers(start, stock.tasks, &forecast);
  add_pictures(start, to_make, &forecast);
  forecast.minutes /= static_cast<double>(start.processes());
  return forecast;
}

}  // namespace rigproof
