// `rigproof sweep` as a user types it.
#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli_fixture.h"
#include "paths.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const char* const kSweep = R"(
mode: geometric
run: {poses: 8}
axes: {lambda: {field: odometry.lambda, values: [1, 3]}}
seeds: 2
methods: [ml, li]
)";

class SweepCommand : public testing::Test {
 protected:
  ProcessOutput sweep(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "sweep");
    return rigproof_command(arguments, folder_.path().string());
  }
  // Starts a long sweep and waits until it works.
  void start_a_long_one() {
    std::string text = kSweep;
    text.replace(text.find("seeds: 2"), 8, "seeds: 3000");
    folder_.write("long.yaml", text);
    long_.emplace(std::vector<std::string>{program_path(), "sweep", "start", "long.yaml", "-j", "1"},
                  folder_.path().string());
    const fs::path tasks = folder_ / "sweeps/long/tasks";
    long_->wait_until([&] { return fs::exists(tasks) && !fs::is_empty(tasks); });
  }
  ProcessOutput interrupt_the_long_one() {
    long_->send(SIGTERM);
    return long_->wait();
  }

  TempFolder folder_;
  std::optional<BackgroundProcess> long_;
};

TEST_F(SweepCommand, SetsFieldsFromTheCommandLine) {
  folder_.write("small.yaml", kSweep);
  const ProcessOutput start = sweep({"start", "small.yaml", "--set", "run.poses=6", "--set", "seeds=1", "--set",
                                     "methods=[li]", "-o", "trial", "--json"});
  ASSERT_EQ(start.exit_code, 0) << start.err;
  EXPECT_EQ(nlohmann::json::parse(start.out)["counters"]["answers solved"], 2);
  // The folder keeps what was set.
  const ProcessOutput again = sweep({"start", "trial", "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["counters"]["answers already there"], 2);
  const ProcessOutput wrong = sweep({"start", "small.yaml", "--set", "run.pose=6"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("--set"), HasSubstr("run.pose"), HasSubstr("did you mean \"poses\"")));
}

// Files may not grow beyond 4 KiB, as on a full disk: one error, no half-written file, and the same tables afterwards.
TEST_F(SweepCommand, AFullDiskIsOneErrorAndTheSweepGoesOn) {
  folder_.write("small.yaml", kSweep);
  const std::string program = program_path();
  const ProcessOutput full = run_process(
      {"sh", "-c", "ulimit -f 8; exec " + program + " sweep start small.yaml -q -o full"}, folder_.path().string());
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.err, AllOf(HasSubstr("cannot write"), HasSubstr("largest size allowed here")));
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "full"))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  ASSERT_EQ(sweep({"start", "small.yaml", "-q", "-o", "full"}).exit_code, 0);
  ASSERT_EQ(sweep({"start", "small.yaml", "-q", "-o", "free"}).exit_code, 0);
  EXPECT_EQ(folder_.read("full/rows.csv"), folder_.read("free/rows.csv"));
}

TEST_F(SweepCommand, StartsTellsAndGoesOn) {
  folder_.write("small.yaml", kSweep);
  const ProcessOutput plan = sweep({"start", "small.yaml", "--dry-run"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_THAT(plan.out,
              AllOf(HasSubstr("lambda 3, seed 1: 0 of 2 answers there"),
                    HasSubstr("2 points, 4 tasks, 8 answers, 0 of them there"), HasSubstr("would write sweeps/small")));
  EXPECT_FALSE(fs::exists(folder_ / "sweeps"));
  const ProcessOutput start = sweep({"start", "small.yaml", "-j", "2"});
  ASSERT_EQ(start.exit_code, 0) << start.err;
  EXPECT_THAT(start.out, AllOf(HasSubstr("Camera to robot"), HasSubstr("success"), HasSubstr("8 answers solved")));
  const ProcessOutput status = sweep({"status", "sweeps/small", "--json"});
  ASSERT_EQ(status.exit_code, 0) << status.err;
  EXPECT_EQ(nlohmann::json::parse(status.out)["answers_there"], 8);
  const ProcessOutput again = sweep({"start", "sweeps/small", "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["counters"]["answers already there"], 8);
  const ProcessOutput summary = sweep({"summary", "sweeps/small"});
  EXPECT_EQ(summary.exit_code, 0);
  EXPECT_THAT(start.out, HasSubstr(summary.out));
}

TEST_F(SweepCommand, SaysWhatIsWrong) {
  folder_.write("bad.yaml", "axes:\n  noise: {field: odometry.lamda, values: [1]}\n");
  const ProcessOutput bad = sweep({"start", "bad.yaml"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, AllOf(HasSubstr("bad.yaml:2"), HasSubstr("did you mean \"odometry.lambda\"")));
  EXPECT_FALSE(fs::exists(folder_ / "sweeps"));
  folder_.write("methods.yaml", "methods: [mll]\n");
  const ProcessOutput method = sweep({"start", "methods.yaml"});
  EXPECT_EQ(method.exit_code, 2);
  EXPECT_THAT(method.err, HasSubstr("did you mean \"ml\""));
  folder_.write("small.yaml", kSweep);
  folder_.write("file", "");
  const ProcessOutput unwritable = sweep({"start", "small.yaml", "-o", "file/results"});
  EXPECT_EQ(unwritable.exit_code, 2);
  EXPECT_THAT(unwritable.err, HasSubstr("file/results"));
  const ProcessOutput redo = sweep({"start", "small.yaml", "--redo", "lii"});
  EXPECT_EQ(redo.exit_code, 2);
  EXPECT_THAT(redo.err, HasSubstr("did you mean \"li\""));
  folder_.write("emptied/sweep.yaml", "");
  const ProcessOutput emptied = sweep({"start", "emptied"});
  EXPECT_EQ(emptied.exit_code, 2);
  EXPECT_THAT(emptied.err, HasSubstr("emptied/sweep.yaml: is empty"));
}

TEST_F(SweepCommand, AnInterruptKeepsWhatIsFinished) {
  start_a_long_one();
  const ProcessOutput output = interrupt_the_long_one();
  EXPECT_EQ(output.exit_code, 75);
  EXPECT_THAT(output.err, HasSubstr("interrupted; the same command goes on"));
  EXPECT_TRUE(fs::exists(folder_ / "sweeps/long/rows.csv"));
}

TEST_F(SweepCommand, ASecondOneInTheFolderIsRefused) {
  start_a_long_one();
  const ProcessOutput second = sweep({"start", "long.yaml"});
  EXPECT_EQ(second.exit_code, 75);
  EXPECT_THAT(second.err, HasSubstr("another rigproof sweeps in this folder"));
  EXPECT_THAT(sweep({"status", "sweeps/long"}).out, HasSubstr("running"));
  EXPECT_EQ(interrupt_the_long_one().exit_code, 75);
}

TEST_F(SweepCommand, ShardsAreMergedOrWhatIsMissingIsNamed) {
  folder_.write("small.yaml", kSweep);
  ASSERT_EQ(sweep({"start", "small.yaml", "-q", "-o", "whole"}).exit_code, 0);
  const ProcessOutput plan = sweep({"plan", "small.yaml", "-o", "a"});
  ASSERT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_EQ(plan.out, "planned    4 tasks  a\n");
  const ProcessOutput run = sweep({"run", "a", "--shard", "1/2", "-j", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("shard      1/2  4 answers"));
  const ProcessOutput partial = sweep({"merge", "a"});
  EXPECT_EQ(partial.exit_code, 1);
  EXPECT_THAT(partial.err, AllOf(HasSubstr("4 answers are missing"), HasSubstr("lambda 1, seed 0, task "),
                                 HasSubstr("`rigproof sweep run a` makes what is missing")));
  ASSERT_EQ(sweep({"run", "a", "-q"}).exit_code, 0);
  EXPECT_THAT(sweep({"status", "a", "--follow"}).out, HasSubstr("8/8 answers of 4 tasks"));
  ASSERT_EQ(sweep({"merge", "a", "-q"}).exit_code, 0);
  for (const char* table : {"rows.csv", "rows.jsonl", "summary.csv", "summary.json", "summary.md"})
    EXPECT_EQ(folder_.read("a/" + std::string(table)), folder_.read("whole/" + std::string(table))) << table;
  for (const char* shard : {"2/2", "-1/2", "1", "a/b", "1/0", "/", ""}) {
    const ProcessOutput bad = sweep({"run", "a", "--shard", shard});
    EXPECT_EQ(bad.exit_code, 2) << shard;
    EXPECT_THAT(bad.err, HasSubstr("INDEX/COUNT")) << shard;
  }
}

TEST_F(SweepCommand, OnlyAFolderThatIsNotThereIsWorthAnotherTry) {
  fs::create_directory(folder_ / "empty");
  for (const char* command : {"run", "status", "merge"}) {
    const ProcessOutput nowhere = sweep({command, "nowhere"});
    EXPECT_EQ(nowhere.exit_code, 75) << command;
    EXPECT_THAT(nowhere.err, HasSubstr("nowhere: is not there"));
    EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
    const ProcessOutput empty = sweep({command, "empty"});
    EXPECT_EQ(empty.exit_code, 2) << command;
    EXPECT_THAT(empty.err, HasSubstr("empty: holds no sweep"));
  }
  folder_.write("file", "");
  EXPECT_EQ(sweep({"run", "file"}).exit_code, 2);
  EXPECT_EQ(sweep({"run", "file/sweep"}).exit_code, 2);
  const ProcessOutput unnamed = sweep({"run", ""});
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("the folder's name is empty"));
}

TEST_F(SweepCommand, WhoeverFollowsWaitsForAFolderThatIsGone) {
  folder_.write("small.yaml", kSweep);
  ASSERT_EQ(sweep({"plan", "small.yaml", "-q", "-o", "a"}).exit_code, 0);
  BackgroundProcess follower({"sh", "-c", "exec " + program_path() + " sweep status a --follow > said.txt"},
                             folder_.path().string());
  const auto said = [this](const std::string& text) {
    return fs::exists(folder_ / "said.txt") && folder_.read("said.txt").find(text) != std::string::npos;
  };
  follower.wait_until([&] { return said("0/8 answers"); });
  fs::rename(folder_ / "a", folder_ / "unmounted");
  follower.wait_until([&] { return said("a: is gone; waiting until it is there again"); });
  fs::rename(folder_ / "unmounted", folder_ / "a");
  ASSERT_EQ(sweep({"run", "a", "-q"}).exit_code, 0);
  EXPECT_EQ(follower.wait().exit_code, 0);
  EXPECT_TRUE(said("8/8 answers  "));
}

// Slurm in a few lines of shell: an array is a loop.
TEST_F(SweepCommand, TheScriptsForSlurmDoTheSweep) {
  const auto command = [&](const std::string& name, const std::string& text) {
    fs::permissions(folder_.write("bin/" + name, "#!/bin/bash\n" + text), fs::perms::owner_all);
  };
  const auto with_slurm = [&](std::vector<std::string> arguments) {
    const std::vector<std::string> env = {"env", "PATH=" + (folder_ / "bin").string() + ":/usr/bin:/bin",
                                          "SLURM_ARRAY_JOB_ID=7", "SLURM_CPUS_PER_TASK=1", "SLURM_ARRAY_TASK_ID=0"};
    arguments.insert(arguments.begin(), env.begin(), env.end());
    return run_process(arguments, folder_.path().string());
  };
  command("sbatch", R"(script=${!#}
echo "$@" >> ../../sbatch.log
last=$(sed -n 's/^#SBATCH --array=0-\([0-9]*\)%1$/\1/p' "$script")
for i in $(seq 0 "${last:-0}"); do SLURM_ARRAY_TASK_ID=$i bash "$script" >> ../../script.log || exit; done
echo "7;cluster")");
  command("scontrol", "echo \"$@\" >> scontrol.log");
  folder_.write("small.yaml", kSweep);
  ASSERT_EQ(sweep({"start", "small.yaml", "-q", "-o", "whole"}).exit_code, 0);
  ASSERT_EQ(sweep({"plan", "small.yaml", "-q", "-o", "it's"}).exit_code, 0);
  EXPECT_THAT(sweep({"slurm", "it's"}).err, HasSubstr("cannot stand in a batch script"));
  ASSERT_EQ(sweep({"plan", "small.yaml", "-q", "-o", "a b"}).exit_code, 0);
  EXPECT_THAT(sweep({"slurm", "a b", "--array", "5"}).err, HasSubstr("the sweep has 4 tasks"));
  EXPECT_THAT(sweep({"slurm", "a b", "--sbatch", "long"}).err, HasSubstr("must be one option of sbatch"));
  const ProcessOutput submit = with_slurm(
      {program_path(), "sweep", "slurm", "a b", "--array", "3", "--throttle", "1", "--sbatch=--time=10", "--submit"});
  ASSERT_EQ(submit.exit_code, 0) << submit.err;
  EXPECT_THAT(submit.out, HasSubstr("3 array tasks and a merge"));
  EXPECT_THAT(folder_.read("sbatch.log"), AllOf(HasSubstr("--parsable"), HasSubstr("--dependency=afterany:7 ")));
  const std::string run = folder_.read("a b/slurm/run.sbatch");
  EXPECT_THAT(run, AllOf(HasSubstr("#SBATCH --requeue\n"), HasSubstr("#SBATCH --time=10\n")));
  EXPECT_EQ(folder_.read("a b/rows.csv"), folder_.read("whole/rows.csv"));
  // A worker that asks for another try is requeued, one that failed is not.
  for (const auto& [code, requeued] : {std::pair(2, ""), std::pair(75, "requeue 7_0\n")}) {
    command("worker", "exit " + std::to_string(code));
    std::string script = run;
    script.replace(script.find(program_path()), program_path().size(), (folder_ / "bin/worker").string());
    const fs::path file = folder_.write("worker.sbatch", script);
    EXPECT_EQ(with_slurm({"bash", file.string()}).exit_code, code);
    EXPECT_EQ(folder_.read("scontrol.log"), requeued);
  }
}

TEST_F(SweepCommand, ItsSchemaKnowsTheRunsFields) {
  const ProcessOutput schema = rigproof_command({"schema", "sweep"});
  ASSERT_EQ(schema.exit_code, 0);
  const nlohmann::json json = nlohmann::json::parse(schema.out);
  EXPECT_TRUE(json["properties"]["run"]["properties"].contains("odometry"));
  EXPECT_TRUE(json["properties"]["geometric"]["properties"].contains("corner_sigma_px"));
}

}  // namespace
}  // namespace rigproof
