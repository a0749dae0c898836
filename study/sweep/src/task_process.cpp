#include "task_process.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/words/sentences.h"
#include "work.h"

namespace rigproof {
namespace {

using nlohmann::json;
using Tell = ForkedJobs::Tell;

std::string line_of(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace); }

// A job tells what went wrong with the machine in its last line, or that it was interrupted.
template <typename Work>
ForkedJobs::Work telling_errors(const SweepStart& start, Work work) {
  return [&start, work](const Tell& tell) {
    cv::setNumThreads(1);  // threads of the process that forked this one are not here
    try {
      work(tell);
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain && !start.keeps_going())
        return tell(line_of({{"interrupted", true}}));
      tell(line_of({{"error", words::message_of(error)}, {"exit_code", static_cast<int>(error.exit_code())}}));
    } catch (const std::exception& error) {
      tell(line_of({{"error", error.what()}, {"exit_code", static_cast<int>(ExitCode::kBadInput)}}));
    }
  };
}

Count counting(const Tell& tell) {
  return [tell](const std::string& name, std::uint64_t more) {
    if (more > 0) tell(line_of({{"count", name}, {"more", more}}));
  };
}

// Another sweep that shares the cache may not delete what a method of this task is going to read.
std::unique_ptr<FolderLock> lock_images(const SweepStart& start, const PendingTask& pending) {
  const std::string& key = pending.task->pictures;
  if (key.empty() || !pending.reads_images() || !start.cache.has_pictures(key, false)) return nullptr;
  auto lock = std::make_unique<FolderLock>(start.cache.reading_lock(key), "its images are being deleted",
                                           FolderLock::Kind::kShared);
  if (!start.cache.has_pictures(key, true))
    throw MachineError(start.cache.pictures(key).root.string() +
                           ": another sweep deleted its images; the same command makes them again",
                       ExitCode::kTryAgain);
  return lock;
}

// Nothing, and the reason in `no_data`, where the task has nothing to calibrate from.
std::optional<TaskData> try_data_of(const SweepStart& start, const SweepTask& task, const Tell& tell,
                                    Finding* why_not) {
  try {
    return data_of(start.config, task, start.cache, counting(tell), start.options.keep_going);
  } catch (const MachineError&) {
    throw;
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    const std::string run = start.cache.pictures(task.pictures).root.string() + "/";
    *why_not = Finding("task.nothing_to_calibrate", {{"text", replaced(words::message_of(error), run, "")}});
    return std::nullopt;
  }
}

SweepAnswer answer_by(const SweepMethod& choice, const Method& method, const TaskData& data) {
  const SweepSight sight(choice.vision);
  if (choice.vision.ground == SweepVision().ground) return answer_of(method, data, sight);
  if (const std::optional<Finding> why_not = why_no_ground(choice.vision, data.recording.has_value()))
    return could_not_run(*why_not, data);
  return answer_of(method, with_ground(data, choice.vision.ground, sight), sight);
}

void solve(const SweepStart& start, const PendingTask& pending, const Tell& tell) {
  const SweepTask& task = *pending.task;
  const std::unique_ptr<FolderLock> reading = lock_images(start, pending);
  Finding why_not;
  const std::optional<TaskData> data = try_data_of(start, task, tell, &why_not);
  const ExternalOptions options{start.folder.logs(task.key), start.options.keep_going};
  for (const SweepMethod* method : pending.methods) {
    tell(line_of({{"start", method->name}}));
    SweepAnswer answer =
        data ? answer_by(*method, *methods_by_name({method->spec}, options).front(), *data) : failed_answer(why_not);
    if (data && data->findings) {
      data->findings->tell(counting(tell));
      data->findings->rethrow();
    }
    if (data) answer.machine.gl_renderer = data->gl_renderer;
    keep_answer(start, task, *method, std::move(answer));
    tell(line_of({{"done", method->name}}));
  }
}

}  // namespace

JobMessage read_message(const std::string& line) {
  const json object = json::parse(line, nullptr, false);
  JobMessage message;
  if (!object.is_object()) return message;
  if (object.contains("task")) message.task = object["task"].get<std::size_t>();
  message.started = object.value("start", "");
  message.done = object.value("done", "");
  message.counted = object.value("count", "");
  message.more = object.value("more", std::uint64_t{0});
  if (object.contains("images")) {
    message.images = object["images"].get<std::size_t>();
    message.images_in_all = object["total"].get<std::size_t>();
  }
  message.interrupted = object.value("interrupted", false);
  message.error = object.value("error", "");
  message.exit_code = static_cast<ExitCode>(object.value("exit_code", 0));
  return message;
}

ForkedJobs::Work picture_work(const SweepStart& start, const PendingPictures& pictures, int processes) {
  return telling_errors(start, [&start, &pictures, processes](const Tell& tell) {
    start.require_folder();
    PictureWork work;
    work.cache = &start.cache;
    work.jobs = processes;
    work.device = start.options.device;
    work.progress = [&tell](std::size_t done, std::size_t total) {
      tell(line_of({{"images", done}, {"total", total}}));
    };
    work.keep_going = [&start] { return start.keeps_going(); };
    work.count = counting(tell);
    make_pictures(pictures.set, pictures.with_images, work);
  });
}

ForkedJobs::Work task_work(const SweepStart& start, std::vector<const PendingTask*> tasks) {
  return telling_errors(start, [&start, tasks = std::move(tasks)](const Tell& tell) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      tell(line_of({{"task", i}}));
      solve(start, *tasks[i], tell);
    }
  });
}

}  // namespace rigproof
