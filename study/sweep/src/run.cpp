// Each task in a process that may die. This one only plans, hands out and gathers: it stays single-threaded, so that it
// may fork.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <map>
#include <set>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/text.h"
#include "stock.h"
#include "task_process.h"
#include "work.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kWaitMs = 100;
constexpr std::size_t kMaxTasksOfProcess = 16;
constexpr int kMaxStarts = 2;  // of a task whose process was killed from outside
constexpr double kBytesOfGb = 1e9;

void refuse_unknown(const std::vector<std::string>& redo, const std::vector<SweepMethod>& methods) {
  std::vector<std::string> known;
  for (const SweepMethod& method : methods) known.push_back(method.name);
  for (const std::string& name : redo)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error("--redo " + for_message(name) + ": is no method of this sweep; " + suggestion(name, known));
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

// Pictures of tasks that are still to be done stay.
void shrink_cache(const SweepStart& start, const Stock& stock) {
  if (start.options.cache_limit_gb <= 0.0) return;
  std::set<std::string> needed;
  for (const PendingTask& pending : stock.tasks)
    if (!pending.methods.empty()) needed.insert(pending.task->pictures);
  start.cache.shrink_to(static_cast<std::uint64_t>(start.options.cache_limit_gb * kBytesOfGb), needed);
}

SweepProgress progress_of(const Stock& stock) {
  SweepProgress progress;
  for (const PendingPictures& set : stock.pictures) {
    progress.images += set.images;
    progress.images_done += set.state == PendingPictures::State::kReady ? set.images : set.images_done;
  }
  progress.answers = stock.answers;
  progress.answers_done = stock.answers_done;
  return progress;
}

// Sets that share clean renders come one after the other, so that each is rendered once.
std::vector<std::size_t> startable_pictures(const std::vector<PendingPictures>& pictures) {
  std::set<std::string> groups;
  for (const PendingPictures& set : pictures)
    if (set.state == PendingPictures::State::kRunning) groups.insert(set.set.render_group);
  std::vector<std::size_t> startable;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (pictures[i].state == PendingPictures::State::kWaiting && groups.insert(pictures[i].set.render_group).second)
      startable.push_back(i);
  return startable;
}

// Hands out what is left and takes in what comes back. Job numbers: first the pictures, then the tasks.
class Dispatcher {
 public:
  Dispatcher(const SweepStart& start, Stock* stock)
      : start_(start), stock_(*stock), slots_(start.processes()), store_(start.folder, start.plan) {
    for (std::size_t i = 0; i < stock_.tasks.size(); ++i) {
      queue_.push_back(i);
      ++left_in_pack_[pack_at(i).first];
    }
    pack_what_is_left();
  }

  bool is_done() const { return queue_.empty() && jobs_.running() == 0; }

  void start_what_is_ready() {
    for (auto it = queue_.begin(); it != queue_.end() && free_slots() > 0;) {
      if (!is_ready(*it)) {
        ++it;
        continue;
      }
      std::vector<std::size_t> tasks;
      const std::size_t most = tasks_of_process();
      for (; it != queue_.end() && tasks.size() < most && is_ready(*it); it = queue_.erase(it)) tasks.push_back(*it);
      start_tasks(std::move(tasks));
    }
    const std::vector<std::size_t> startable = startable_pictures(stock_.pictures);
    for (std::size_t i = 0; i < startable.size() && free_slots() > 0; ++i)
      start_pictures(startable[i], std::max<std::size_t>(1, free_slots() / (startable.size() - i)));
  }

  // Returns false if a job was interrupted.
  bool take_news(int timeout_ms) {
    bool interrupted = false;
    for (const ForkedJobs::News& news : jobs_.wait(timeout_ms)) {
      if (news.ended)
        end_job(news);
      else
        interrupted = take(news.job, read_message(news.line)) || interrupted;
    }
    return !interrupted;
  }

 private:
  struct TaskJob {
    std::vector<std::size_t> tasks;
    std::size_t at = 0;  ///< which of them it is doing
  };

  // A process may have died between the last answer and its pack, or have seen it in the cache.
  void pack_what_is_left() {
    std::map<std::size_t, PackRange> ranges;
    for (std::size_t place = start_.first; place < start_.last; ++place) {
      const PackRange range = pack_of(place, start_.order);
      if (left_in_pack_.count(range.first) == 0 && store_.has_single(start_.order[place].task->key))
        ranges[range.first] = range;
    }
    for (const auto& [first, range] : ranges) store_.pack_if_complete(start_.order, range);
  }

  PackRange pack_at(std::size_t index) const { return pack_of(stock_.tasks[index].place, start_.order); }

  std::size_t free_slots() const {
    std::size_t used = 0;
    for (const auto& [job, processes] : processes_) used += processes;
    return used < slots_ ? slots_ - used : 0;
  }

  bool is_ready(std::size_t index) const {
    const std::optional<std::size_t>& pictures = stock_.tasks[index].pictures;
    return !pictures || stock_.pictures[*pictures].state == PendingPictures::State::kReady;
  }

  // Without pictures a task may take less time than the start of a process. Few enough that all processes end at about
  // the same time.
  std::size_t tasks_of_process() const {
    if (!stock_.pictures.empty()) return 1;
    return std::clamp<std::size_t>(queue_.size() / (4 * slots_), 1, kMaxTasksOfProcess);
  }

  void start_tasks(std::vector<std::size_t> tasks) {
    std::vector<const PendingTask*> pending;
    for (const std::size_t index : tasks) pending.push_back(&stock_.tasks[index]);
    ++stock_.tasks[tasks.front()].starts;
    const std::size_t job = stock_.pictures.size() + tasks.front();
    processes_[job] = 1;
    task_jobs_[job] = {std::move(tasks), 0};
    jobs_.start(job, task_work(start_, std::move(pending)));
  }

  void start_pictures(std::size_t index, std::size_t processes) {
    PendingPictures& set = stock_.pictures[index];
    set.state = PendingPictures::State::kRunning;
    processes_[index] = processes;
    jobs_.start(index, picture_work(start_, set, static_cast<int>(processes)));
  }

  // Returns whether the job was interrupted.
  bool take(std::size_t job, const JobMessage& message) {
    if (!message.error.empty()) throw Error(message.error, message.exit_code);
    if (!message.counted.empty()) stock_.counters[message.counted] += message.more;
    if (message.images) {
      stock_.pictures[job].images_done = *message.images;
      stock_.pictures[job].images = *message.images_in_all;
    }
    if (job < stock_.pictures.size()) return message.interrupted;
    TaskJob& tasks = task_jobs_.at(job);
    if (message.task) tasks.at = *message.task;
    const std::size_t index = tasks.tasks.at(tasks.at);
    PendingTask& pending = stock_.tasks[index];
    if (message.task && tasks.at > 0) ++pending.starts;
    for (const SweepMethod* method : pending.methods)
      if (method->name == message.started) pending.current = method;
    if (!message.done.empty()) finish_current(index);
    return message.interrupted;
  }

  void finish_current(std::size_t index) {
    PendingTask& pending = stock_.tasks[index];
    pending.methods.erase(std::find(pending.methods.begin(), pending.methods.end(), pending.current));
    pending.current = nullptr;
    stock_.answers_done += pending.repeats;
    stock_.counters["answers solved"] += 1;
    if (pending.methods.empty()) finish_task(index);
  }

  void end_job(const ForkedJobs::News& news) {
    processes_.erase(news.job);
    if (news.job < stock_.pictures.size()) return end_pictures(news);
    const TaskJob job = task_jobs_.at(news.job);
    task_jobs_.erase(news.job);
    const std::size_t at = job.tasks.at(job.at);
    if (!news.end.is_good() && !stock_.tasks[at].methods.empty()) bury(at, news.end);
    for (auto index = job.tasks.rbegin(); index != job.tasks.rend(); ++index)
      if (!stock_.tasks[*index].methods.empty()) queue_.push_front(*index);
  }

  void finish_task(std::size_t index) {
    const PackRange range = pack_at(index);
    if (--left_in_pack_[range.first] > 0) return;
    start_.require_folder();
    store_.pack_if_complete(start_.order, range);
  }

  // A process that died: the method that it was at has failed; one that was killed may have been the machine's fault.
  void bury(std::size_t index, const ProcessEnd& end) {
    PendingTask& pending = stock_.tasks[index];
    const bool again = end.signal == SIGKILL && pending.starts < kMaxStarts;
    if (!again && pending.current == nullptr)
      throw Error("the process of task " + pending.task->key + " " + end.in_words() +
                      " while it put the observations together; what is finished is kept",
                  ExitCode::kTryAgain);
    if (!again) {
      keep_answer(start_, *pending.task, *pending.current,
                  failed_answer(Finding("method.died", {{"text", end.in_words()}})));
      finish_current(index);
      pending.starts = 0;
    }
    pending.current = nullptr;
  }

  void end_pictures(const ForkedJobs::News& news) {
    if (!news.end.is_good())
      throw Error("the process that makes pictures " + news.end.in_words() +
                      "; what is finished is kept: the same command goes on from there",
                  ExitCode::kTryAgain);
    PendingPictures& set = stock_.pictures[news.job];
    set.state = PendingPictures::State::kReady;
    set.images_done = set.images;
    shrink_cache(start_, stock_);
  }

  const SweepStart& start_;
  Stock& stock_;
  const std::size_t slots_;
  std::map<std::size_t, std::size_t> processes_;     ///< by job
  std::map<std::size_t, TaskJob> task_jobs_;         ///< by job
  std::list<std::size_t> queue_;                     ///< indices of tasks
  const AnswerStore store_;                          ///< as it was before
  std::map<std::size_t, std::size_t> left_in_pack_;  ///< tasks that are to be done, by the pack's first place
  ForkedJobs jobs_;                                  ///< the first to go
};

// Returns false if it was interrupted; whatever still runs is ended.
bool work_through(const SweepStart& start, Stock* stock) {
  Dispatcher dispatcher(start, stock);
  while (!dispatcher.is_done()) {
    if (!start.keeps_going()) return false;
    dispatcher.start_what_is_ready();
    if (!dispatcher.take_news(kWaitMs)) return false;
    if (start.options.progress) start.options.progress(progress_of(*stock));
  }
  return true;
}

SweepTables write_tables(const SweepStart& start, const Stock& stock, const SweepCounters& before) {
  shrink_cache(start, stock);
  SweepCounters all = before;
  for (const auto& [name, count] : stock.counters) all[name] += count;
  save_counters(start.folder, stock.counters, all);
  return gather_sweep(start.folder.root);
}

// What is finished is in the tables, whatever ended the work.
void work_and_gather(const SweepStart& start, const SweepCounters& before, Stock* stock, SweepReport* report) {
  try {
    report->complete = work_through(start, stock);
  } catch (...) {
    try {
      write_tables(start, *stock, before);
    } catch (const Error&) {
      // The first failure is the one to tell; often this one has the same cause, such as a full disk.
    }
    throw;
  }
  report->tables = write_tables(start, *stock, before);
}

// Alone in the folder.
void write_plan(const SweepStart& start) {
  write_file_atomically(start.folder.config_file(), emit_yaml(resolved_sweep(start.config)));
  save_folder_plan(start.folder, start.plan);
  remove_leftovers(start.folder.tasks());
  remove_leftovers(start.folder.packs());
}

std::string shown(const std::vector<std::string>& names) { return names.empty() ? "none" : joined(names); }

void require_same(const SweepFolder& folder, const std::string& what, const std::vector<std::string>& now,
                  const std::vector<std::string>& planned) {
  if (now != planned)
    throw Error(folder.config_file().string() + ": " + what + ": " + shown(now) + "; planned were " + shown(planned) +
                ": the file is damaged, or was changed after the plan was made; put it back, or plan again");
}

// The tasks of the plan are indices into these.
void refuse_other_axes(const SweepStart& start) {
  const SweepRows now = sweep_plan_of(start.config, {}, start.methods, {}).table;
  const SweepRows& planned = start.plan.table;
  require_same(start.folder, "axes", now.axes, planned.axes);
  for (std::size_t i = 0; i < planned.axes.size(); ++i)
    require_same(start.folder, "levels of axis " + planned.axes[i], now.levels[i], planned.levels[i]);
}

void refuse_other_methods(const SweepStart& start) {
  std::vector<std::string> names;
  for (const SweepMethod& method : start.methods) names.push_back(method.name);
  require_same(start.folder, "methods", names, start.plan.table.methods);
  for (std::size_t i = 0; i < start.methods.size(); ++i)
    if (start.methods[i].hash != start.plan.hashes[i])
      throw Error(start.folder.root.string() + ": was planned by another build of rigproof, or with another " +
                  start.methods[i].name + ": the same program and files must be on every machine; else plan again");
}

std::vector<SweepTask> tasks_of_shard(const SweepStart& start) {
  std::vector<SweepTask> tasks;
  for (std::size_t place = start.first; place < start.last; ++place) tasks.push_back(*start.order[place].task);
  return tasks;
}

void tell(const Stock& stock, Clock::time_point begin, SweepReport* report) {
  report->answers = stock.answers_done;
  report->counters = stock.counters;
  report->seconds = std::chrono::duration<double>(Clock::now() - begin).count();
}

constexpr const char* kInUse = "another rigproof sweeps in this folder";

}  // namespace

std::size_t plan_folder(const SweepConfig& config, const SweepOptions& options) {
  SweepStart start = start_of(config, options);
  const FolderLock lock(start.folder.root, kInUse);
  plan_all(&start);
  write_plan(start);
  return start.order.size();
}

SweepReport run_sweep(const SweepConfig& config, const SweepOptions& options) {
  const auto begin = Clock::now();
  SweepStart start = start_of(config, options);
  refuse_unknown(options.redo, start.methods);
  const FolderLock lock(start.folder.root, kInUse);
  plan_all(&start);
  write_plan(start);
  const SweepCounters before = load_counters(start.folder);
  Stock stock = take_stock(start, false);
  SweepReport report;
  work_and_gather(start, before, &stock, &report);
  tell(stock, begin, &report);
  return report;
}

SweepReport run_shard(const SweepOptions& options, const SweepShard& shard) {
  const auto begin = Clock::now();
  const SweepFolder folder{options.folder};
  SweepPlan plan = load_folder_plan(folder);
  const SweepConfig config = load_sweep_config(sweep_config_file(folder.root));
  const FolderLock lock(folder.root, kInUse, FolderLock::Kind::kShared);
  SweepStart start = start_of(config, options);
  start.plan = std::move(plan);
  start.take_shard(shard);
  refuse_other_axes(start);
  refuse_other_methods(start);
  check_planned(config, tasks_of_shard(start));
  Stock stock = take_stock(start, false);
  SweepReport report;
  report.complete = work_through(start, &stock);
  tell(stock, begin, &report);
  return report;
}

}  // namespace rigproof
