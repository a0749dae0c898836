#include "stock.h"

#include <algorithm>
#include <map>
#include <thread>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

// Of earlier starts; a damaged plan is written anew.
std::vector<std::string> added_before(const SweepFolder& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder.plan_file(), ignored)) return {};
  try {
    return load_folder_plan(folder).added;
  } catch (const Error&) {
    return {};
  }
}

bool is_there(const SweepStart& start, const AnswerStore& store, const SweepTask& task, std::size_t index,
              bool only_look, SweepCounters* counters) {
  const SweepMethod& method = start.methods[index];
  const std::vector<std::string>& redo = start.options.redo;
  if (std::find(redo.begin(), redo.end(), method.name) != redo.end()) return false;
  if (store.load(task.key, index)) {
    (*counters)["answers already there"] += 1;
    return true;
  }
  if (method.outside) return false;  // what it reads beside its input is not known
  const std::optional<std::string> kept = start.cache.solution(task.key, method.stored);
  std::optional<SweepAnswer> known = kept ? read_answer(*kept) : std::nullopt;
  if (!known) return false;
  known->method_hash = method.hash;  // another sweep may have another name for it
  if (!only_look) start.require_folder();
  if (!only_look) write_file_atomically_unsynced(start.folder.answer_file(task.key, method.name), text_of(*known));
  (*counters)["answers from cache"] += 1;
  return true;
}

std::size_t images_in(const GenerateConfig& config) {
  const std::size_t stops = static_cast<std::size_t>(config.poses + config.straight_drive.frames);
  return stops * load_rig_model(config.rig).rig.cameras.size();
}

PendingPictures pending_pictures(const SweepStart& start, const SweepTask& task) {
  PendingPictures pictures;
  pictures.set = pictures_of(start.config, task);
  pictures.images = images_in(pictures.set.config);
  return pictures;
}

// What is left of the task at a place in the order of work.
PendingTask pending_task(const SweepStart& start, const AnswerStore& store, std::size_t place, bool only_look,
                         SweepCounters* counters) {
  PendingTask pending;
  pending.task = start.order[place].task;
  pending.repeats = start.order[place].repeats;
  pending.place = place;
  for (std::size_t i = 0; i < start.methods.size(); ++i)
    if (!is_there(start, store, *pending.task, i, only_look, counters)) pending.methods.push_back(&start.methods[i]);
  return pending;
}

// Those that the tasks need; each task learns its own.
std::vector<PendingPictures> needed_pictures(const SweepStart& start, std::vector<PendingTask>* tasks) {
  std::vector<PendingPictures> pictures;
  std::map<std::string, std::size_t> by_key;
  for (PendingTask& pending : *tasks) {
    const std::string& key = pending.task->pictures;
    if (key.empty()) continue;
    const auto [place, is_new] = by_key.emplace(key, pictures.size());
    if (is_new) pictures.push_back(pending_pictures(start, *pending.task));
    pending.pictures = place->second;
    pictures[place->second].with_images = pictures[place->second].with_images || pending.reads_images();
  }
  return pictures;
}

}  // namespace

void SweepStart::require_folder() const {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder.plan_file(), ignored))
    throw Error(folder.root.string() + ": is gone; once it is there again the same command goes on",
                ExitCode::kTryAgain);
}

std::size_t SweepStart::processes() const {
  return options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : std::max(1U, std::thread::hardware_concurrency());
}

SweepStart start_of(const SweepConfig& config, const SweepOptions& options) {
  const SweepFolder folder{options.folder};
  std::vector<std::string> added = with_added(added_before(folder), options.add);
  std::vector<SweepMethod> methods = sweep_methods(config, added);
  return {config,
          options,
          folder,
          SweepCache(options.cache.empty() ? options.folder / "cache" : options.cache),
          std::move(added),
          std::move(methods),
          {},
          {},
          0,
          0};
}

void SweepStart::take_shard(const SweepShard& shard) {
  order = work_order(plan.table.tasks);
  first = order.size() * shard.index / shard.count;
  last = order.size() * (shard.index + 1) / shard.count;
}

void plan_all(SweepStart* start) {
  start->plan = sweep_plan_of(start->config, plan_sweep(start->config), start->methods, start->added);
  start->take_shard({});
}

bool PendingTask::reads_images() const {
  return std::any_of(methods.begin(), methods.end(), [](const SweepMethod* method) { return method->reads_images; });
}

Stock take_stock(const SweepStart& start, bool only_look) {
  Stock stock;
  const AnswerStore store(start.folder, start.plan);
  for (std::size_t place = start.first; place < start.last; ++place) {
    PendingTask pending = pending_task(start, store, place, only_look, &stock.counters);
    stock.answers += start.methods.size() * pending.repeats;
    stock.answers_done += (start.methods.size() - pending.methods.size()) * pending.repeats;
    if (!pending.methods.empty()) stock.tasks.push_back(std::move(pending));
  }
  stock.pictures = needed_pictures(start, &stock.tasks);
  for (PendingPictures& set : stock.pictures) {
    if (!start.cache.is_observed(set.set.key) || !start.cache.has_pictures(set.set.key, set.with_images)) continue;
    set.state = PendingPictures::State::kReady;
    stock.counters["image sets from cache"] += 1;
    if (!only_look) start.cache.mark_used(set.set.key);
  }
  return stock;
}

void keep_answer(const SweepStart& start, const SweepTask& task, const SweepMethod& method, SweepAnswer answer) {
  start.require_folder();
  answer.method_hash = method.hash;
  const SweepMachine& here = this_machine();
  answer.machine.host = here.host;
  answer.machine.cpu = here.cpu;
  const std::string text = text_of(answer);
  write_file_atomically_unsynced(start.folder.answer_file(task.key, method.name), text);
  if (!method.outside) start.cache.keep_solution(task.key, method.stored, text);
}

}  // namespace rigproof
