// One process a task. This one only plans, hands out and gathers: it stays single-threaded, so that it may fork.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <thread>

#include "cache.h"
#include "cost.h"
#include "folder.h"
#include "jobs.h"
#include "rigproof/calib/ml_settings.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/generate.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/external.h"
#include "rigproof/study/sweep.h"
#include "work.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr int kWaitMs = 100;
constexpr int kMaxStarts = 2;  // of a task whose process was killed from outside
constexpr double kBytesOfGb = 1e9;

std::string replaced_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string line_of(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace); }

// A job tells what went wrong with the machine in its last line, or that it was interrupted.
void telling_errors(const ForkedJobs::Tell& tell, const std::function<bool()>& keep_going,
                    const std::function<void()>& work) {
  cv::setNumThreads(1);  // threads of the process that forked this one are not here
  try {
    work();
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain && keep_going && !keep_going())
      return tell(line_of({{"interrupted", true}}));
    tell(line_of({{"error", error.what()}, {"exit_code", static_cast<int>(error.exit_code())}}));
  } catch (const std::exception& error) {
    tell(line_of({{"error", error.what()}, {"exit_code", static_cast<int>(ExitCode::kBadInput)}}));
  }
}

Count counting(const ForkedJobs::Tell& tell) {
  return [tell](const std::string& name, std::uint64_t more) {
    if (more > 0) tell(line_of({{"count", name}, {"more", more}}));
  };
}

void remove_leftovers(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> leftovers;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.front() == '.' && it->path().extension() == ".tmp") leftovers.push_back(it->path());
  }
  for (const fs::path& file : leftovers) fs::remove(file, error);
}

// What is left of one task; tasks of the same key are one.
struct PendingTask {
  const SweepTask* task = nullptr;
  std::vector<const SweepMethod*> methods;
  const SweepMethod* current = nullptr;  ///< that its process is at
  int starts = 0;
};

struct PendingPictures {
  const PictureSet* set = nullptr;
  bool with_images = false;
  std::size_t images = 0, images_done = 0;
  enum class State { kWaiting, kRunning, kReady } state = State::kWaiting;
};

class Sweep {
 public:
  Sweep(const SweepConfig& config, const SweepOptions& options)
      : config_(config),
        options_(options),
        folder_{options.folder},
        cache_(options.cache.empty() ? options.folder / "cache" : options.cache),
        slots_(options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))) {}

  SweepReport run() {
    const auto start = Clock::now();
    plan_.added = added_methods(folder_, options_.add);
    methods_ = sweep_methods(all_methods(config_, plan_.added));
    refuse_unknown_redo();
    const FolderLock lock(folder_.root, "another rigproof sweeps in this folder");
    tasks_ = plan_sweep(config_);
    plan_.table = table_of(config_, tasks_, methods_);
    write_file_atomically(folder_.config_file(), emit_yaml(config_.resolved));
    save_folder_plan(folder_, plan_);
    remove_leftovers(folder_.tasks());
    before_ = load_counters(folder_);
    take_stock();
    SweepReport report;
    report.complete = work_or_gather();
    finish();
    report.answers = answers_done_;
    report.counters = counters_;
    report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return report;
  }

  static std::vector<SweepMethodChoice> all_methods(const SweepConfig& config, const std::vector<std::string>& added) {
    std::vector<SweepMethodChoice> choices = config.methods;
    for (const std::string& spec : added) {
      const auto same = [&spec](const SweepMethodChoice& choice) { return choice.label() == spec; };
      if (std::none_of(choices.begin(), choices.end(), same)) choices.push_back({spec, {}, config.vision});
    }
    return choices;
  }

  // Those of earlier starts, then new ones. A file is a method from outside.
  static std::vector<std::string> added_methods(const SweepFolder& folder, const std::vector<std::string>& more) {
    std::vector<std::string> added;
    std::error_code ignored;
    if (fs::is_regular_file(folder.plan_file(), ignored)) {
      try {
        added = load_folder_plan(folder).added;
      } catch (const Error&) {
        // a damaged plan is written anew
      }
    }
    const std::string prefix = "external:", ml = kMlPrefix;
    for (std::string spec : more) {
      if (spec.rfind(ml, 0) == 0) {
        if (names_ml_file(spec.substr(ml.size())))
          spec = ml + fs::absolute(spec.substr(ml.size())).lexically_normal().string();
        if (std::find(added.begin(), added.end(), spec) == added.end()) added.push_back(spec);
        continue;
      }
      const bool external = spec.rfind(prefix, 0) == 0;
      const fs::path file = external ? spec.substr(prefix.size()) : spec;
      if (external || file.extension() == ".yaml" || file.extension() == ".yml")
        spec = prefix + fs::absolute(file).lexically_normal().string();
      if (std::find(added.begin(), added.end(), spec) == added.end()) added.push_back(spec);
    }
    return added;
  }

  /// What is there already and what is not, without changing anything.
  SweepForecast forecast() {
    plan_.added = added_methods(folder_, options_.add);
    methods_ = sweep_methods(all_methods(config_, plan_.added));
    tasks_ = plan_sweep(config_);
    only_look_ = true;
    take_stock();
    SweepForecast forecast;
    forecast.tasks = tasks_.tasks.size();
    forecast.points = config_.seeds.empty() ? 0 : forecast.tasks / config_.seeds.size();
    forecast.answers = forecast.tasks * methods_.size();
    forecast.answers_there = answers_done_;
    forecast.picture_sets = tasks_.pictures.size();
    forecast.picture_sets_there = tasks_.pictures.size();
    for (const PendingPictures& set : pictures_) {
      if (set.state == PendingPictures::State::kReady) continue;
      if (cache_.has_pictures(set.set->key, true)) continue;
      --forecast.picture_sets_there;
      forecast.images_to_render += set.images;
    }
    tell_tasks(&forecast);
    estimate_cost(&forecast);
    return forecast;
  }

 private:
  // Pictures by the first set that is to be made; everything else by what it takes on one core.
  void estimate_cost(SweepForecast* forecast) const {
    double seconds = 0.0;
    for (const PendingTask& pending : pending_) {
      const double views = views_of(*pending.task);
      seconds += seconds_of_observations(views);
      for (const SweepMethod* method : pending.methods)
        seconds += seconds_of_answer(method->spec, method->outside, views);
    }
    const auto is_to_make = [this](const PendingPictures& set) {
      return set.state != PendingPictures::State::kReady && !cache_.has_pictures(set.set->key, true);
    };
    const auto to_make = std::find_if(pictures_.begin(), pictures_.end(), is_to_make);
    if (to_make != pictures_.end()) {
      const GeneratePlan plan = plan_generation(to_make->set->config);
      const double sets = static_cast<double>(forecast->images_to_render) / static_cast<double>(plan.images);
      forecast->megabytes = sets * plan.expected_mb;
      const double cores = std::max(1U, std::thread::hardware_concurrency());
      seconds += sets * plan.expected_minutes * 60.0 * cores;
      const double megapixels = megapixels_of(to_make->set->config);
      const bool follows_features = std::any_of(methods_.begin(), methods_.end(), [](const SweepMethod& method) {
        return method.spec == "robot_autocalib" || method.spec == "sensorx2car" || method.vision.ground == "images";
      });
      seconds += static_cast<double>(forecast->images_to_render) *
                 (seconds_of_search(megapixels) + (follows_features ? seconds_of_matching(megapixels) : 0.0));
    }
    forecast->minutes = seconds / 60.0 / slots_;
  }

  void tell_tasks(SweepForecast* forecast) const {
    for (const SweepTask& task : tasks_.tasks) {
      std::string line;
      for (std::size_t i = 0; i < task.levels.size(); ++i)
        line += config_.axes[i].name + " " + config_.axes[i].levels[task.levels[i]].label + ", ";
      line += "seed " + std::to_string(task.seed) + ": ";
      const auto same = [&task](const PendingTask& pending) { return pending.task->key == task.key; };
      const auto pending = std::find_if(pending_.begin(), pending_.end(), same);
      const std::size_t left = pending == pending_.end() ? 0 : pending->methods.size();
      forecast->task_lines.push_back(line + std::to_string(methods_.size() - left) + " of " +
                                     std::to_string(methods_.size()) + " answers there");
    }
    if (!config_.geometric) return;
    for (const SweepMethod& method : methods_) {
      if (!method.reads_images) continue;
      std::string why_not = methods_by_name({method.spec}).front()->why_not({Observations(), nullptr, 1});
      if (why_not.empty()) why_not = why_no_ground(method, false);
      if (!why_not.empty()) forecast->cannot_run.push_back(method.name + ": " + why_not);
    }
  }

  void refuse_unknown_redo() const {
    std::vector<std::string> known;
    for (const SweepMethod& method : methods_) known.push_back(method.name);
    for (const std::string& name : options_.redo)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw Error("--redo " + for_message(name) + ": is no method of this sweep; " + suggestion(name, known));
  }

  bool is_redone(const SweepMethod& method) const {
    return std::find(options_.redo.begin(), options_.redo.end(), method.name) != options_.redo.end();
  }

  // Finds what is finished, here or in the cache; what is left is pending, and so are the pictures that it needs.
  void take_stock() {
    std::map<std::string, std::size_t> by_key;
    std::map<std::string, std::size_t> set_index;
    for (const SweepTask& task : tasks_.tasks) {
      answers_ += methods_.size();
      const auto [place, is_new] = by_key.emplace(task.key, 0);
      ++place->second;
      if (!is_new) continue;
      PendingTask pending;
      pending.task = &task;
      for (const SweepMethod& method : methods_)
        if (!is_there(task, method)) pending.methods.push_back(&method);
      if (!pending.methods.empty()) pending_.push_back(pending);
    }
    repeats_ = by_key;
    answers_done_ = answers_;
    for (const PendingTask& pending : pending_) answers_done_ -= pending.methods.size() * repeats_[pending.task->key];
    for (const PendingTask& pending : pending_) need_pictures(pending, &set_index);
    for (PendingPictures& set : pictures_) {
      if (cache_.is_observed(set.set->key) && cache_.has_pictures(set.set->key, set.with_images)) {
        set.state = PendingPictures::State::kReady;
        counters_["image sets from cache"] += 1;
        if (!only_look_) cache_.mark_used(set.set->key);
      }
    }
  }

  bool is_there(const SweepTask& task, const SweepMethod& method) {
    if (is_redone(method)) return false;
    const std::optional<SweepAnswer> answer = load_answer(folder_, task.key, method.name);
    if (answer && answer->method_hash == method.hash) {
      counters_["answers already there"] += 1;
      return true;
    }
    if (method.outside) return false;  // what it reads beside its input is not known
    const std::optional<std::string> kept = cache_.solution(task.key, method.stored);
    std::optional<SweepAnswer> known = kept ? read_answer(*kept) : std::nullopt;
    if (!known) return false;
    known->method_hash = method.hash;  // another sweep may have another name for it
    if (!only_look_) write_file_atomically_unsynced(folder_.answer_file(task.key, method.name), text_of(*known));
    counters_["answers from cache"] += 1;
    return true;
  }

  void need_pictures(const PendingTask& pending, std::map<std::string, std::size_t>* index) {
    const std::string& key = pending.task->pictures;
    if (key.empty()) return;
    const auto [place, is_new] = index->emplace(key, pictures_.size());
    if (is_new) {
      const auto same = [&key](const PictureSet& set) { return set.key == key; };
      PendingPictures& set = pictures_.emplace_back();
      set.set = &*std::find_if(tasks_.pictures.begin(), tasks_.pictures.end(), same);
      set.images = images_in(set.set->config);
    }
    pictures_[place->second].with_images =
        pictures_[place->second].with_images ||
        std::any_of(pending.methods.begin(), pending.methods.end(), [](const auto* m) { return m->reads_images; });
    set_of_[&*pending.task] = place->second;
  }

  static std::size_t images_in(const GenerateConfig& config) {
    const std::size_t stops = static_cast<std::size_t>(config.poses + config.straight_drive.frames);
    return stops * load_rig_model(config.rig).rig.cameras.size();
  }

  bool is_ready(const PendingTask& pending) const {
    const auto set = set_of_.find(pending.task);
    return set == set_of_.end() || pictures_[set->second].state == PendingPictures::State::kReady;
  }

  // What is finished is in the tables, whatever ended the work.
  bool work_or_gather() {
    try {
      return work();
    } catch (...) {
      jobs_.stop();
      try {
        finish();
      } catch (const Error&) {
        // The first failure is the one to tell; often this one has the same cause, such as a full disk.
      }
      throw;
    }
  }

  // Returns false if it was interrupted.
  bool work() {
    for (std::size_t i = 0; i < pending_.size(); ++i) queue_.push_back(i);
    while (!queue_.empty() || jobs_.running() > 0) {
      if (options_.keep_going && !options_.keep_going()) return stop();
      start_jobs();
      for (const ForkedJobs::News& news : jobs_.wait(kWaitMs)) take(news);
      if (interrupted_) return stop();
      tell_progress();
    }
    return true;
  }

  bool stop() {
    jobs_.stop();
    return false;
  }

  void start_jobs() {
    for (auto it = queue_.begin(); it != queue_.end() && used_slots_ < slots_;) {
      if (is_ready(pending_[*it])) {
        start_task(*it);
        it = queue_.erase(it);
      } else {
        ++it;
      }
    }
    std::vector<std::size_t> startable = startable_pictures();
    for (std::size_t i = 0; i < startable.size() && used_slots_ < slots_; ++i) {
      const int left = static_cast<int>(startable.size() - i);
      start_pictures(startable[i], std::max(1, (slots_ - used_slots_) / left));
    }
  }

  // Sets that share clean renders come one after the other, so that each is rendered once.
  std::vector<std::size_t> startable_pictures() const {
    std::set<std::string> groups;
    for (const PendingPictures& set : pictures_)
      if (set.state == PendingPictures::State::kRunning) groups.insert(set.set->render_group);
    std::vector<std::size_t> startable;
    for (std::size_t i = 0; i < pictures_.size(); ++i)
      if (pictures_[i].state == PendingPictures::State::kWaiting &&
          groups.insert(pictures_[i].set->render_group).second)
        startable.push_back(i);
    return startable;
  }

  void start_pictures(std::size_t index, int processes) {
    PendingPictures& set = pictures_[index];
    set.state = PendingPictures::State::kRunning;
    used_slots_ += slots_of_[index] = processes;
    jobs_.start(index, [this, &set, processes](const ForkedJobs::Tell& tell) {
      telling_errors(tell, options_.keep_going, [&] {
        PictureWork work;
        work.cache = &cache_;
        work.jobs = processes;
        work.device = options_.device;
        work.progress = [&tell](std::size_t done, std::size_t total) {
          tell(line_of({{"images", done}, {"total", total}}));
        };
        work.keep_going = [this] { return !options_.keep_going || options_.keep_going(); };
        work.count = counting(tell);
        make_pictures(*set.set, set.with_images, work);
      });
    });
  }

  void start_task(std::size_t index) {
    PendingTask& pending = pending_[index];
    ++pending.starts;
    const std::size_t job = pictures_.size() + index;
    used_slots_ += slots_of_[job] = 1;
    jobs_.start(job, [this, &pending](const ForkedJobs::Tell& tell) {
      telling_errors(tell, options_.keep_going, [&] { solve(pending, tell); });
    });
  }

  // Another sweep that shares the cache may not delete what a method of this task is going to read.
  std::unique_ptr<FolderLock> lock_images(const PendingTask& pending) const {
    const std::string& key = pending.task->pictures;
    const bool reads = std::any_of(pending.methods.begin(), pending.methods.end(),
                                   [](const SweepMethod* method) { return method->reads_images; });
    if (key.empty() || !reads || !cache_.has_pictures(key, false)) return nullptr;
    auto lock = std::make_unique<FolderLock>(cache_.reading_lock(key), "its images are being deleted",
                                             FolderLock::Kind::kShared);
    if (!cache_.has_pictures(key, true))
      throw MachineError(
          cache_.pictures(key).root.string() + ": another sweep deleted its images; the same command makes them again",
          ExitCode::kTryAgain);
    return lock;
  }

  // In the task's process.
  void solve(const PendingTask& pending, const ForkedJobs::Tell& tell) const {
    const std::unique_ptr<FolderLock> reading = lock_images(pending);
    std::optional<TaskData> data;
    std::string no_data;
    try {
      data = data_of(*pending.task, cache_, counting(tell), options_.keep_going);
    } catch (const MachineError&) {
      throw;
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain) throw;
      const std::string run = cache_.pictures(pending.task->pictures).root.string() + "/";
      no_data = "Nothing to calibrate from: " + replaced_all(error.what(), run, "");
    }
    for (const SweepMethod* method : pending.methods) {
      tell(line_of({{"start", method->name}}));
      SweepAnswer answer;
      if (data) {
        const ExternalOptions options{folder_.logs(pending.task->key), options_.keep_going};
        answer = answer_by(*method, *methods_by_name({method->spec}, options).front(), *data);
      } else {
        answer = failed_answer(SweepStatus::kFailed, no_data);
      }
      if (data && data->findings) {
        data->findings->tell(counting(tell));
        data->findings->rethrow();
      }
      keep(*pending.task, *method, std::move(answer));
      tell(line_of({{"done", method->name}}));
    }
  }

  static SweepAnswer answer_by(const SweepMethod& choice, const Method& method, const TaskData& data) {
    const SweepSight sight(choice.vision);
    if (choice.vision.ground == SweepVision().ground) return answer_of(method, data, sight);
    if (const std::string why_not = why_no_ground(choice, data.recording.has_value()); !why_not.empty())
      return could_not_run(why_not, data);
    return answer_of(method, with_ground(data, choice.vision.ground, sight), sight);
  }

  static std::string why_no_ground(const SweepMethod& choice, bool has_images) {
    if (choice.vision.ground != "images" || has_images) return {};
    return "It takes the ground from images, and the input is observations alone.";
  }

  void keep(const SweepTask& task, const SweepMethod& method, SweepAnswer answer) const {
    answer.method_hash = method.hash;
    const std::string text = text_of(answer);
    write_file_atomically_unsynced(folder_.answer_file(task.key, method.name), text);
    if (!method.outside) cache_.keep_solution(task.key, method.stored, text);
  }

  void take(const ForkedJobs::News& news) {
    if (!news.ended) return take_line(news.job, json::parse(news.line, nullptr, false));
    used_slots_ -= slots_of_[news.job];
    if (news.job < pictures_.size()) return end_pictures(news);
    PendingTask& pending = pending_[news.job - pictures_.size()];
    if (news.signal != 0 || news.exit_code != 0) return bury(news, &pending);
    pending.methods.clear();
  }

  void take_line(std::size_t job, const json& message) {
    if (!message.is_object()) return;
    interrupted_ = interrupted_ || message.contains("interrupted");
    if (message.contains("error"))
      throw Error(message["error"].get<std::string>(), static_cast<ExitCode>(message["exit_code"].get<int>()));
    if (message.contains("count"))
      counters_[message["count"].get<std::string>()] += message["more"].get<std::uint64_t>();
    if (message.contains("images")) {
      pictures_[job].images_done = message["images"].get<std::size_t>();
      pictures_[job].images = message["total"].get<std::size_t>();
    }
    if (job < pictures_.size()) return;
    PendingTask& pending = pending_[job - pictures_.size()];
    const auto named = [&pending](const std::string& name) {
      return std::find_if(pending.methods.begin(), pending.methods.end(),
                          [&name](const SweepMethod* method) { return method->name == name; });
    };
    if (message.contains("start")) pending.current = *named(message["start"].get<std::string>());
    if (!message.contains("done")) return;
    pending.methods.erase(named(message["done"].get<std::string>()));
    finished(pending);
  }

  void finished(PendingTask& pending) {
    pending.current = nullptr;
    answers_done_ += repeats_[pending.task->key];
    counters_["answers solved"] += 1;
  }

  // A process that died: the method that it was at has failed; one that was killed may have been the machine's fault.
  void bury(const ForkedJobs::News& news, PendingTask* pending) {
    const bool again = news.signal == SIGKILL && pending->starts < kMaxStarts;
    const std::string how = news.signal != 0
                                ? "signal " + std::to_string(news.signal) + " (" + strsignal(news.signal) + ")"
                                : "exit code " + std::to_string(news.exit_code);
    if (!again && pending->current == nullptr)
      throw Error("the process of task " + pending->task->key + " died by " + how +
                      " while it put the observations together; what is finished is kept",
                  ExitCode::kTryAgain);
    if (!again) {
      keep(*pending->task, *pending->current,
           failed_answer(SweepStatus::kFailed, "The method's process died by " + how + "."));
      pending->methods.erase(std::find(pending->methods.begin(), pending->methods.end(), pending->current));
      pending->starts = 0;
      finished(*pending);
    }
    pending->current = nullptr;
    if (!pending->methods.empty()) queue_.push_front(static_cast<std::size_t>(pending - pending_.data()));
  }

  void end_pictures(const ForkedJobs::News& news) {
    if (news.signal != 0 || news.exit_code != 0)
      throw Error("the process that makes pictures died (signal " + std::to_string(news.signal) +
                      "); what is finished is kept: the same command goes on from there",
                  ExitCode::kTryAgain);
    PendingPictures& set = pictures_[news.job];
    set.state = PendingPictures::State::kReady;
    set.images_done = set.images;
    shrink_cache();
  }

  // Pictures of tasks that are still to be done stay.
  void shrink_cache() const {
    if (options_.cache_limit_gb <= 0.0) return;
    std::set<std::string> needed;
    for (const PendingTask& pending : pending_)
      if (!pending.methods.empty()) needed.insert(pending.task->pictures);
    cache_.shrink_to(static_cast<std::uint64_t>(options_.cache_limit_gb * kBytesOfGb), needed);
  }

  void tell_progress() const {
    if (!options_.progress) return;
    SweepProgress progress;
    for (const PendingPictures& set : pictures_) {
      progress.images += set.images;
      progress.images_done += set.state == PendingPictures::State::kReady ? set.images : set.images_done;
    }
    progress.answers = answers_;
    progress.answers_done = answers_done_;
    options_.progress(progress);
  }

  void finish() {
    shrink_cache();
    SweepCounters all = before_;
    for (const auto& [name, count] : counters_) all[name] += count;
    save_counters(folder_, counters_, all);
    gather_sweep(folder_.root);
  }

  const SweepConfig& config_;
  const SweepOptions& options_;
  SweepFolder folder_;
  SweepCache cache_;
  int slots_;
  int used_slots_ = 0;
  bool interrupted_ = false;  ///< as a job saw it
  bool only_look_ = false;
  FolderPlan plan_;
  SweepPlan tasks_;
  std::vector<SweepMethod> methods_;
  std::vector<PendingTask> pending_;
  std::vector<PendingPictures> pictures_;
  std::map<const SweepTask*, std::size_t> set_of_;  ///< index in pictures_
  std::map<std::string, std::size_t> repeats_;      ///< tasks of a key
  std::map<std::size_t, int> slots_of_;             ///< by job
  std::list<std::size_t> queue_;                    ///< indices in pending_
  std::size_t answers_ = 0, answers_done_ = 0;
  SweepCounters counters_, before_;
  ForkedJobs jobs_;
};

}  // namespace

SweepReport run_sweep(const SweepConfig& config, const SweepOptions& options) { return Sweep(config, options).run(); }

SweepForecast forecast_sweep(const SweepConfig& config, const SweepOptions& options) {
  return Sweep(config, options).forecast();
}

}  // namespace rigproof
