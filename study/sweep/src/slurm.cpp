#include "rigproof/study/sweep/slurm.h"

#include <algorithm>

#include "answer_store.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTasksOfShard = 100, kMaxArray = 1000;  // Slurm's own limit is 1001 unless it was raised

// What a comment line of sbatch and a shell in single quotes both take as it is.
std::string quotable(const fs::path& path) {
  const std::string text = fs::absolute(path).lexically_normal().string();
  const auto is_bad = [](unsigned char c) { return c < ' ' || c == '\'' || c == '"' || c == '\\' || c == '%'; };
  if (std::any_of(text.begin(), text.end(), is_bad))
    throw Error(for_message(text) + ": quotes, backslashes, % and control characters cannot stand in a batch script");
  return text;
}

std::string options_text(const SlurmJob& job, const std::string& log) {
  std::string text = "#SBATCH --output=\"" + quotable(job.folder / "slurm") + "/" + log + "\"\n";
  for (const std::string& option : job.options) {
    if (option.rfind("--", 0) != 0 || option.find('\n') != std::string::npos)
      throw Error("--sbatch " + for_message(option) + ": must be one option of sbatch, such as --partition=long");
    text += "#SBATCH " + option + "\n";
  }
  return text;
}

std::string command_text(const SlurmJob& job, const std::string& command) {
  return "'" + quotable(job.program) + "' sweep " + command + " '" + quotable(job.folder) + "'";
}

// The shell stays, to ask for another try where the worker says that one may help. Slurm tells the shell alone that the
// time is nearly up.
std::string run_script(const SlurmJob& job, const std::string& name, std::size_t array) {
  const std::string throttle = job.throttle > 0 ? "%" + std::to_string(job.throttle) : "";
  const std::string cache = job.cache.empty() ? "" : " --cache '" + quotable(job.cache) + "'";
  return "#!/bin/bash\n#SBATCH --job-name=" + name + "\n#SBATCH --array=0-" + std::to_string(array - 1) + throttle +
         "\n#SBATCH --cpus-per-task=" + std::to_string(job.cpus) +
         "\n#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --signal=B:TERM@60\n" + options_text(job, "%a.log") +
         command_text(job, "run") + " --shard \"$SLURM_ARRAY_TASK_ID/" + std::to_string(array) +
         "\" -j \"$SLURM_CPUS_PER_TASK\"" + cache + R"( &
worker=$!
trap 'kill -TERM "$worker"' TERM
code=143
while [ "$code" -gt 128 ]; do # a signal ended the wait, perhaps not the worker
  wait "$worker"
  code=$?
  kill -0 "$worker" 2>/dev/null || break
done
if [ "$code" -eq 75 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 20 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
)";
}

std::string merge_script(const SlurmJob& job, const std::string& name) {
  return "#!/bin/bash\n#SBATCH --job-name=" + name + "-merge\n#SBATCH --open-mode=append\n" +
         options_text(job, "merge.log") + "exec " + command_text(job, "merge") + "\n";
}

std::string submit_script(const SlurmScripts& scripts) {
  return "#!/bin/bash\nset -euo pipefail\njob=$(sbatch --parsable '" + quotable(scripts.run) +
         "')\nsbatch --dependency=\"afterany:${job%%;*}\" '" + quotable(scripts.merge) + "'\n";
}

}  // namespace

SlurmScripts write_slurm_scripts(const SlurmJob& job) {
  const SweepPlan plan = load_folder_plan({job.folder});
  const std::size_t tasks = work_order(plan.table.tasks).size();
  const fs::path folder = job.folder / "slurm";
  SlurmScripts scripts{folder / "run.sbatch", folder / "merge.sbatch", folder / "submit", job.array};
  if (job.array == 0) scripts.array = std::min((tasks + kTasksOfShard - 1) / kTasksOfShard, kMaxArray);
  if (scripts.array > tasks)
    throw Error("--array " + std::to_string(job.array) + ": the sweep has " + std::to_string(tasks) + " tasks");
  write_file_atomically(scripts.run, run_script(job, plan.table.name, scripts.array));
  write_file_atomically(scripts.merge, merge_script(job, plan.table.name));
  write_file_atomically(scripts.submit, submit_script(scripts));
  return scripts;
}

}  // namespace rigproof
