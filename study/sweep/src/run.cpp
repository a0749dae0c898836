// One process a task. This one only plans, hands out and gathers: it stays single-threaded, so that it may fork.
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
    if (set.state == PendingPictures::State::kRunning) groups.insert(set.set->render_group);
  std::vector<std::size_t> startable;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (pictures[i].state == PendingPictures::State::kWaiting && groups.insert(pictures[i].set->render_group).second)
      startable.push_back(i);
  return startable;
}

// Hands out what is left and takes in what comes back. Job numbers: first the pictures, then the tasks.
class Dispatcher {
 public:
  Dispatcher(const SweepStart& start, Stock* stock) : start_(start), stock_(*stock), slots_(start.processes()) {
    for (std::size_t i = 0; i < stock_.tasks.size(); ++i) queue_.push_back(i);
  }

  bool is_done() const { return queue_.empty() && jobs_.running() == 0; }

  void start_what_is_ready() {
    for (auto it = queue_.begin(); it != queue_.end() && free_slots() > 0;) {
      const auto& pictures = stock_.tasks[*it].pictures;
      if (pictures && stock_.pictures[*pictures].state != PendingPictures::State::kReady) {
        ++it;
        continue;
      }
      start_task(*it);
      it = queue_.erase(it);
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
  std::size_t free_slots() const {
    std::size_t used = 0;
    for (const auto& [job, processes] : processes_) used += processes;
    return used < slots_ ? slots_ - used : 0;
  }

  void start_task(std::size_t index) {
    PendingTask& pending = stock_.tasks[index];
    ++pending.starts;
    const std::size_t job = stock_.pictures.size() + index;
    processes_[job] = 1;
    jobs_.start(job, task_work(start_, pending));
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
    PendingTask& pending = stock_.tasks[job - stock_.pictures.size()];
    for (const SweepMethod* method : pending.methods)
      if (method->name == message.started) pending.current = method;
    if (!message.done.empty()) finish_current(&pending);
    return message.interrupted;
  }

  void finish_current(PendingTask* pending) {
    pending->methods.erase(std::find(pending->methods.begin(), pending->methods.end(), pending->current));
    pending->current = nullptr;
    stock_.answers_done += pending->repeats;
    stock_.counters["answers solved"] += 1;
  }

  void end_job(const ForkedJobs::News& news) {
    processes_.erase(news.job);
    if (news.job < stock_.pictures.size()) return end_pictures(news);
    const std::size_t index = news.job - stock_.pictures.size();
    if (news.end.is_good()) return stock_.tasks[index].methods.clear();
    bury(index, news.end);
    if (!stock_.tasks[index].methods.empty()) queue_.push_front(index);
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
      finish_current(&pending);
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
  std::map<std::size_t, std::size_t> processes_;  ///< by job
  std::list<std::size_t> queue_;                  ///< indices of tasks
  ForkedJobs jobs_;                               ///< the first to go
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

void write_tables(const SweepStart& start, const Stock& stock, const SweepCounters& before) {
  shrink_cache(start, stock);
  SweepCounters all = before;
  for (const auto& [name, count] : stock.counters) all[name] += count;
  save_counters(start.folder, stock.counters, all);
  gather_sweep(start.folder.root);
}

// What is finished is in the tables, whatever ended the work.
bool work_and_gather(const SweepStart& start, const SweepCounters& before, Stock* stock) {
  bool complete = false;
  try {
    complete = work_through(start, stock);
  } catch (...) {
    try {
      write_tables(start, *stock, before);
    } catch (const Error&) {
      // The first failure is the one to tell; often this one has the same cause, such as a full disk.
    }
    throw;
  }
  write_tables(start, *stock, before);
  return complete;
}

}  // namespace

SweepReport run_sweep(const SweepConfig& config, const SweepOptions& options) {
  const auto begin = Clock::now();
  SweepStart start = start_of(config, options);
  refuse_unknown(options.redo, start.methods);
  const FolderLock lock(start.folder.root, "another rigproof sweeps in this folder");
  start.plan = plan_sweep(config);
  write_file_atomically(start.folder.config_file(), emit_yaml(resolved_sweep(config)));
  save_folder_plan(start.folder, {table_of(config, start.plan, start.methods), start.added});
  remove_leftovers(start.folder.tasks());
  const SweepCounters before = load_counters(start.folder);
  Stock stock = take_stock(start, false);
  SweepReport report;
  report.complete = work_and_gather(start, before, &stock);
  report.answers = stock.answers_done;
  report.counters = stock.counters;
  report.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return report;
}

}  // namespace rigproof
