// Sweeps in shards: whatever happens to the processes and to the folder, the tables are those of one machine, or what
// is missing is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "error_text.h"
#include "rigproof/core/child_process.h"
#include "rigproof/study/sweep/slurm.h"
#include "sweep_folders.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A pack and a bit: shards end within packs.
const char* const kTwoPacks = R"(
mode: geometric
run: {poses: 3}
axes:
  lambda: {field: odometry.lambda, values: [0.5, 2]}
seeds: {count: 52}
methods: [li]
)";
const char* const kSome = R"(
mode: geometric
run: {poses: 4}
seeds: {count: 30}
methods: [li]
)";

class SweepShards : public SweepFolders {
 protected:
  // What one machine makes of it, and the plan of the same.
  void plan(const std::string& text = kSmall) {
    run_sweep(config(text), options("whole"));
    plan_folder(config(text), options("a"));
  }
  SweepReport run(std::size_t index, std::size_t count) const { return run_shard(options("a", 1), {index, count}); }
  // Every answer is there, and makes the tables of one machine.
  void expect_whole() const {
    EXPECT_THAT(gather_sweep(folder_ / "a").missing, testing::IsEmpty());
    EXPECT_EQ(tables("a"), tables("whole"));
  }
  static ExitCode exit_code_of(const std::function<void()>& call) {
    try {
      call();
      return ExitCode::kGood;
    } catch (const Error& error) {
      return error.exit_code();
    }
  }
  ExitCode exit_code_of_run() const {
    return exit_code_of([this] { run(0, 1); });
  }
};

TEST_F(SweepShards, GiveTheTablesOfOneMachine) {
  plan();
  for (const std::size_t index : {6U, 2U, 4U, 0U, 1U, 3U, 5U}) {
    const SweepReport report = run(index, 7);  // more than there are tasks
    EXPECT_TRUE(report.complete);
    EXPECT_LE(report.answers, 2U);
  }
  expect_whole();
  EXPECT_EQ(run(0, 1).counters.at("answers already there"), 8U);
}

TEST_F(SweepShards, WhatIsMissingIsNamed) {
  plan();
  run(0, 2);
  const SweepTables tables = gather_sweep(folder_ / "a");
  ASSERT_EQ(tables.missing.size(), 4U);
  EXPECT_THAT(tables.missing[0], testing::MatchesRegex("lambda 2, seed 0, task [0-9a-f]{16}: ml"));
  EXPECT_EQ(tables.summary.rows.front().missing, 0);
  EXPECT_EQ(tables.summary.rows.back().missing, 2);
  EXPECT_EQ(sweep_state(folder_ / "a").answers_there, 4U);
  run(1, 2);
  expect_whole();
}

TEST_F(SweepShards, PacksHoldWhatSingleFilesDid) {
  plan(kTwoPacks);
  for (const std::size_t index : {0U, 1U, 2U, 3U}) run(index, 4);
  EXPECT_TRUE(fs::is_empty(folder_ / "a" / "tasks"));
  const fs::directory_iterator packs(folder_ / "a" / "packs");
  EXPECT_EQ(std::distance(fs::begin(packs), fs::end(packs)), 2);
  EXPECT_EQ(sweep_state(folder_ / "a").answers_there, 104U);
  expect_whole();
  // A changed plan keeps what it still needs.
  SweepOptions more = options("a");
  more.cache = folder_ / "none";
  std::string text = kTwoPacks;
  text.replace(text.find("52"), 2, "54");
  EXPECT_EQ(run_sweep(config(text), more).counters.at("answers solved"), 4U);
}

TEST_F(SweepShards, KilledAtAnyMomentAndStartedTwiceTheyComeToTheSame) {
  plan(kSome);
  std::mt19937 random(7);
  for (int round = 0; round < 17; ++round) {  // 51 kills
    ChildProcess one([&] { return run(0, 2).complete ? 0 : 1; });
    ChildProcess twin([&] { return run(0, 2).complete ? 0 : 1; });
    ChildProcess other([&] { return run(1, 2).complete ? 0 : 1; });
    for (ChildProcess* process : {&one, &twin, &other}) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
      process->send(SIGKILL);
    }
  }
  ChildProcess twin([&] { return run(0, 2).complete ? 0 : 1; });
  EXPECT_TRUE(run(0, 2).complete);
  EXPECT_TRUE(twin.wait().is_good());
  run(1, 2);
  expect_whole();
}

TEST_F(SweepShards, ATruncatedResultIsMadeAgain) {
  plan();
  run(0, 2);
  const fs::path single = fs::directory_iterator(folder_ / "a" / "tasks")->path() / "ml.json";
  fs::resize_file(single, fs::file_size(single) / 2);
  EXPECT_EQ(gather_sweep(folder_ / "a").missing.size(), 5U);
  run(0, 1);
  expect_whole();
}

TEST_F(SweepShards, AFolderThatVanishesIsWorthAnotherTry) {
  plan(kSome);
  SweepOptions vanishing = options("a", 1);
  vanishing.progress = [this](const SweepProgress& progress) {
    if (progress.answers_done > 0 && fs::exists(folder_ / "a" / "plan.json"))
      fs::rename(folder_ / "a", folder_ / "moved");
  };
  EXPECT_EQ(exit_code_of([&] { run_shard(vanishing, {}); }), ExitCode::kTryAgain);
  fs::remove_all(folder_ / "a");  // the one answer that was being written
  fs::rename(folder_ / "moved", folder_ / "a");
  EXPECT_EQ(exit_code_of_run(), ExitCode::kGood);
  expect_whole();
}

TEST_F(SweepShards, AFolderThatIsNotThereYetIsWorthAnotherTry) {
  plan();
  fs::rename(folder_ / "a", folder_ / "unmounted");
  EXPECT_EQ(exit_code_of_run(), ExitCode::kTryAgain);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  fs::create_directory(folder_ / "a");
  EXPECT_EQ(exit_code_of_run(), ExitCode::kBadInput) << "there, without a plan";
  fs::remove(folder_ / "a");
  fs::rename(folder_ / "unmounted", folder_ / "a");
  EXPECT_EQ(exit_code_of_run(), ExitCode::kGood);
  expect_whole();
}

// Where the machine grants no file system of its own, nothing can be tested.
TEST_F(SweepShards, AFullDiskIsWorthAnotherTry) {
  run_sweep(config(), options("whole"));
  fs::create_directory(folder_ / "a");
  const std::string disk = folder_ / "a";
  constexpr int kNoNamespace = 99;
  ChildProcess worker([&] {
    const bool own = unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0;
    if (!own || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=48k") != 0)
      return kNoNamespace;
    plan_folder(config(), options("a"));
    if (exit_code_of_run() != ExitCode::kTryAgain) return 1;
    if (mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=16m") != 0) return 2;
    if (exit_code_of_run() != ExitCode::kGood || !gather_sweep(disk).missing.empty()) return 3;
    return tables("a") == tables("whole") ? 0 : 4;
  });
  const ProcessEnd end = worker.wait();
  if (end.exit_code == kNoNamespace) GTEST_SKIP() << "no mount namespace";
  EXPECT_EQ(end.exit_code, 0);
}

TEST_F(SweepShards, AnotherProgramOrAnotherFileIsRefused) {
  plan();
  const std::string plan = folder_.read("a/plan.json");
  const std::size_t hashes = plan.find("\"hashes\":[\"") + 11;
  folder_.write("a/plan.json", std::string(plan).replace(hashes, 4, "0000"));
  EXPECT_THAT(error_text([&] { run(0, 1); }), HasSubstr("was planned by another build of rigproof, or with another"));
  EXPECT_THAT(gather_sweep(folder_ / "a").missing, testing::SizeIs(8));
  const SweepRows rows = load_sweep_rows(folder_ / "a");
  std::string other = plan;
  other.replace(other.find(rows.tasks[3].key), 4, "0000");
  folder_.write("a/plan.json", other);
  EXPECT_THAT(error_text([&] { run(1, 2); }), HasSubstr("was planned with other files or by another program"));
}

// The tasks of a plan are places among the axes and levels of the configuration.
TEST_F(SweepShards, AConfigurationThatLostAPartIsRefused) {
  plan(R"(
mode: geometric
axes:
  lambda: {field: odometry.lambda, values: [0.5, 2]}
  stops: {field: poses, values: [4, 8]}
methods: [ml, li]
)");
  const std::string whole = folder_.read("a/sweep.yaml");
  const auto refused = [&](const std::string& text) {
    folder_.write("a/sweep.yaml", text);
    EXPECT_EQ(exit_code_of_run(), ExitCode::kBadInput) << text;
    return error_text([&] { run(3, 4); });
  };
  const auto with_instead = [&](const std::string& part, const std::string& instead) {
    std::string text = whole;
    const std::size_t at = text.find(part);
    return at == std::string::npos ? "no " + part : text.replace(at, part.size(), instead);
  };
  EXPECT_THAT(refused(""), HasSubstr("a/sweep.yaml: is empty"));
  const std::size_t axes = whole.find("axes:"), seeds = whole.find("seeds:");
  ASSERT_LT(axes, seeds) << whole;
  EXPECT_THAT(refused(with_instead(whole.substr(axes, seeds - axes), "")),
              HasSubstr("a/sweep.yaml: axes: none; planned were lambda, stops"));
  EXPECT_THAT(refused(with_instead("      - 8\n", "")), HasSubstr("levels of axis stops: 4; planned were 4, 8"));
  EXPECT_THAT(refused(with_instead("  - li\n", "")), HasSubstr("methods: ml; planned were ml, li"));
  EXPECT_THAT(refused(with_instead("  - li\n", "  - li\n  - memroc\n")), HasSubstr("planned were ml, li"));
  folder_.write("a/sweep.yaml", whole);
  EXPECT_EQ(exit_code_of_run(), ExitCode::kGood);
  expect_whole();
}

TEST_F(SweepShards, MachinesAreRecordedAndMixedDriversKnown) {
  plan();
  run(0, 2);
  EXPECT_THAT(sweep_state(folder_ / "a").machines, testing::SizeIs(1));
  const std::string task = fs::directory_iterator(folder_ / "a" / "tasks")->path().filename().string();
  for (const char* name : {"ml", "li"}) {
    const std::string file = "a/tasks/" + task + "/" + name + ".json";
    std::string text = folder_.read(file);
    const std::size_t machine = text.find("\"machine\":[");
    ASSERT_NE(machine, std::string::npos);
    text.replace(machine, text.find(']', machine) - machine,
                 "\"machine\":[\"far\",\"cpu\",\"GL of " + std::string(name) + "\"");
    folder_.write(file, text);
  }
  run(1, 2);  // packs all
  const SweepState state = sweep_state(folder_ / "a");
  ASSERT_EQ(state.machines.size(), 3U);
  EXPECT_EQ(state.machines[0].machine.host + state.machines[1].machine.host, "farfar");
  EXPECT_EQ(state.machines[0].machine.gl_renderer, "GL of li");
  EXPECT_TRUE(has_mixed_renderers(state.machines));
  EXPECT_FALSE(has_mixed_renderers({state.machines[0], state.machines[2]}));
  EXPECT_EQ(answers_by_renderer(load_sweep_rows(folder_ / "a").machines),
            (std::map<std::string, std::size_t>{{"GL of li", 1}, {"GL of ml", 1}}));
  EXPECT_THAT(folder_.read("whole/times.csv"), HasSubstr("observe_s,host,cpu,gl_renderer"));
  expect_whole();
}

}  // namespace
}  // namespace rigproof
