// Sweeps without pictures: the same bytes however they come about, and nothing done twice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <thread>

#include "error_text.h"
#include "rigproof/core/child_process.h"
#include "rigproof/core/folder_lock.h"
#include "rigproof/words/sentences.h"
#include "sweep_folders.h"
#include "work.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SweepRun : public SweepFolders {
 protected:
  std::vector<SweepRow> rig_rows(const std::string& name, const std::string& method) const {
    std::vector<SweepRow> found;
    for (const SweepRow& row : load_sweep_rows(folder_ / name).rows)
      if (row.method == method && row.subject == SweepSubject::kRig) found.push_back(row);
    return found;
  }

  // A method from outside that is a shell script.
  std::string script(const std::string& name, const std::string& text, const std::string& more = "") const {
    folder_.write(name + ".sh", text);
    return folder_
        .write(name + ".yaml",
               "command: [sh, \"{here}/" + name + ".sh\", \"{input}\", \"{output}\"]\ninput: observations\n" + more)
        .string();
  }
};

TEST_F(SweepRun, GivesOneRowForEachTaskMethodAndCamera) {
  const SweepReport report = run_sweep(config(), options("a"));
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.answers, 8U);
  EXPECT_EQ(report.counters.at("answers solved"), 8U);
  EXPECT_EQ(report.counters.at("observations made"), 4U) << "one for both methods";
  const SweepRows rows = load_sweep_rows(folder_ / "a");
  EXPECT_EQ(rows.tasks.size(), 4U);
  // Rig, three cameras, three pairs.
  EXPECT_EQ(rows.rows.size(), 8U * 7U);
  for (const SweepRow& row : rows.rows) {
    if (row.subject == SweepSubject::kRig) continue;
    EXPECT_TRUE(row.bound[0].has_value()) << row.camera;
    if (row.method == "li" && row.subject == SweepSubject::kCamera) {
      EXPECT_EQ(row.status, SweepStatus::kNotGiven);
      EXPECT_FALSE(row.error[0].has_value());
    } else {
      EXPECT_EQ(row.status, SweepStatus::kSolved) << words::text_of(row.reasons);
      ASSERT_TRUE(row.z(0).has_value());
      EXPECT_LT(std::abs(*row.z(0)), 6.0);
    }
  }
  const std::string csv = folder_.read("a/rows.csv");
  EXPECT_EQ(csv.substr(0, csv.find("sigma")),
            "task,lambda,seed,method,subject,camera,status,reason,tx_cm,ty_cm,tz_cm,rx_deg,ry_deg,rz_deg,roll_deg,"
            "pitch_deg,yaw_deg,");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 57);
  EXPECT_THAT(folder_.read("a/times.csv"), HasSubstr("solve_s,cpu_s,observe_s"));
}

// Views at stops 0 1 2 5 are two motions, 4 6 none.
TEST(SweepRowsOfAResult, CountHowOftenACameraSawTheBoardAtTwoStopsInARow) {
  TaskData data;
  data.truth.cameras.resize(2);
  data.truth.cameras[0].name = "left";
  data.truth.cameras[1].name = "right";
  for (const auto& [stop, camera] : {std::make_pair(0, 0), {1, 0}, {2, 0}, {4, 1}, {5, 0}, {6, 1}}) {
    BoardView view;
    view.stop = stop;
    view.camera = camera;
    data.observations.board_views.push_back(view);
  }
  SweepAnswer answer;
  answer.rows = rows_of(Result(), SweepStatus::kRefused, data);
  for (const std::vector<SweepRow>& rows : {answer.rows, read_answer(text_of(answer)).value().rows}) {
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_FALSE(rows[0].motions.has_value());
    EXPECT_EQ(rows[1].motions, 2);
    EXPECT_EQ(rows[2].motions, 0);
    EXPECT_EQ(rows[3].motions, 0) << "of the pair the smaller";
  }
}

TEST_F(SweepRun, GivesTheSameBytesAtAnyNumberOfJobs) {
  run_sweep(config(), options("one", 1));
  run_sweep(config(), options("three", 3));
  EXPECT_EQ(tables("one"), tables("three"));
}

TEST_F(SweepRun, DoesNothingTwice) {
  run_sweep(config(), options("a"));
  const std::string first = tables("a");
  const SweepReport again = run_sweep(config(), options("a"));
  EXPECT_EQ(again.counters.at("answers already there"), 8U);
  EXPECT_EQ(again.counters.count("answers solved"), 0U);
  EXPECT_EQ(tables("a"), first);
  // Another level: only that is new. Another folder with the same cache: nothing is.
  std::string more = kSmall;
  more.replace(more.find("[0.5, 2]"), 8, "[0.5, 2, 4]");
  EXPECT_EQ(run_sweep(config(more), options("a")).counters.at("answers solved"), 4U);
  SweepOptions elsewhere = options("b");
  elsewhere.cache = folder_ / "a_cache";
  const SweepReport copied = run_sweep(config(), elsewhere);
  EXPECT_EQ(copied.counters.at("answers from cache"), 8U);
  EXPECT_EQ(copied.counters.count("answers solved"), 0U);
  EXPECT_EQ(tables("b"), first);
  SweepOptions redo = options("a");
  redo.cache = folder_ / "empty_cache";
  redo.redo = {"li"};
  EXPECT_EQ(run_sweep(config(), redo).counters.at("answers solved"), 4U);
}

TEST_F(SweepRun, AddsAMethodBesideFinishedOnes) {
  run_sweep(config(), options("a"));
  SweepOptions add = options("a");
  add.add = {script("theirs",
                    "echo '- {parent: base_footprint, child: left, translation_m: [0.3, 0.1, 0.6], "
                    "quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}' > \"$2\"")};
  const SweepReport report = run_sweep(config(), add);
  EXPECT_EQ(report.counters.at("answers solved"), 4U);
  EXPECT_EQ(report.counters.at("answers already there"), 8U);
  EXPECT_EQ(rig_rows("a", "theirs").size(), 4U);
  // It stays, and is done again only if it changes.
  EXPECT_EQ(run_sweep(config(), options("a")).counters.at("answers already there"), 12U);
  script("theirs", "exit 1");
  EXPECT_EQ(run_sweep(config(), options("a")).counters.at("answers solved"), 4U);
  EXPECT_EQ(rig_rows("a", "theirs")[0].status, SweepStatus::kFailed);
}

TEST_F(SweepRun, TheForecastTakesProgramsFromOutsideForAsLongAsTheyTook) {
  SweepOptions first = options("a");
  first.add = {script("theirs",
                      "sleep 0.5; echo '- {parent: base_footprint, child: left, translation_m: [0.3, 0.1, 0.6], "
                      "quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}' > \"$2\"")};
  EXPECT_EQ(forecast_sweep(config(), first).answers_not_timed, 4U);
  run_sweep(config(), first);
  std::string more = kSmall;
  more.replace(more.find("count: 2"), 8, "count: 7");
  const SweepForecast forecast = forecast_sweep(config(more), options("a", 1));
  EXPECT_EQ(forecast.answers_not_timed, 0U);
  EXPECT_GE(60.0 * forecast.minutes, 10 * 0.5);
  EXPECT_LE(60.0 * forecast.minutes, 10 * 0.5 * 1.5);
  EXPECT_GE(60.0 * forecast_sweep(config(more), options("a", 8)).minutes, 2 * 0.5) << "8 tasks, then 2";
}

TEST_F(SweepRun, WhatBreaksIsAFailedRowWithItsReason) {
  SweepOptions run = options("a");
  run.add = {folder_.write("gone.yaml", "command: [/no/such/program]\ninput: observations\n").string(),
             script("crash", "kill -SEGV $$"), script("hang", "sleep 60", "time_limit_s: 0.2\n"),
             script("garbage", "head -c 1000 /dev/urandom > \"$2\""),
             folder_.write("images.yaml", "command: [\"true\"]\ninput: recording\n").string()};
  std::string one_task = kSmall;
  one_task.replace(one_task.find("count: 2"), 8, "count: 1");
  one_task.replace(one_task.find("[0.5, 2]"), 8, "[1]");
  const SweepReport report = run_sweep(config(one_task), run);
  EXPECT_TRUE(report.complete) << "a failure is an answer";
  const auto is = [this](const std::string& method, SweepStatus status, const char* code, const char* reason) {
    const std::vector<SweepRow> rows = rig_rows("a", method);
    ASSERT_EQ(rows.size(), 1U) << method;
    EXPECT_EQ(rows[0].status, status) << method;
    EXPECT_EQ(code_of(rows[0].reasons), code) << method;
    EXPECT_THAT(words::text_of(rows[0].reasons), HasSubstr(reason)) << method;
  };
  is("gone", SweepStatus::kFailed, "program.failed", "cannot be started: /no/such/program");
  is("crash", SweepStatus::kFailed, "program.failed", "signal 11");
  is("hang", SweepStatus::kFailed, "program.failed", "longer than its limit of 0.2 s");
  is("garbage", SweepStatus::kFailed, "program.bad_answer", "is no result");
  is("images", SweepStatus::kCouldNotRun, "method.needs_recording", "needs the images");
  const SweepForecast forecast = forecast_sweep(config(one_task), options("a"));
  ASSERT_EQ(forecast.cannot_run.size(), 1U);
  EXPECT_THAT(forecast.cannot_run[0], HasSubstr("images: It needs the images"));
}

TEST_F(SweepRun, AConfigurationThatLeavesNothingToCalibrateIsAFailedRow) {
  const std::string text = R"(
mode: geometric
axes: {poses: {field: poses, values: [1, 8]}, used: {field: images, values: [1, 8]}}
methods: [ml]
)";
  EXPECT_THAT(error_text([&] { config(text); }), HasSubstr("at most the run's poses, 1"));
  const SweepConfig blind = config(
      "mode: geometric\nrun: {viewpoints: {distance_m: 0.31, max_candidates: 2}, poses: 3}\ngeometric: {rig: run}\n");
  run_sweep(blind, options("blind"));
  const std::vector<SweepRow> rows = rig_rows("blind", "ml");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].status, SweepStatus::kFailed);
  EXPECT_EQ(code_of(rows[0].reasons), "task.nothing_to_calibrate");
  EXPECT_THAT(words::text_of(rows[0].reasons), HasSubstr("Nothing to calibrate from"));
}

TEST_F(SweepRun, DegenerateDrivesAreRefusedNotFailed) {
  run_sweep(config("mode: geometric\nrun: {poses: 8}\ngeometric: {drive: straight}\nmethods: [ml]\n"), options("a"));
  const std::vector<SweepRow> rows = rig_rows("a", "ml");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_TRUE(rows[0].status == SweepStatus::kPartial || rows[0].status == SweepStatus::kRefused);
  EXPECT_THAT(words::text_of(rows[0].reasons), HasSubstr("straight"));
}

TEST_F(SweepRun, AnInterruptedSweepGoesOn) {
  run_sweep(config(), options("whole"));
  SweepOptions interrupted = options("a", 1);
  std::size_t done = 0;
  interrupted.progress = [&done](const SweepProgress& progress) { done = progress.answers_done; };
  interrupted.keep_going = [&done] { return done < 2; };
  const SweepReport report = run_sweep(config(), interrupted);
  EXPECT_FALSE(report.complete);
  EXPECT_LT(report.answers, 8U);
  EXPECT_GE(report.answers, 2U);
  const SweepTables partial = gather_sweep(folder_ / "a");
  EXPECT_EQ(partial.missing.size(), 8U - report.answers);
  const std::vector<SummaryRow>& rows = partial.summary.rows;
  EXPECT_GT(std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.missing > 0; }), 0);
  EXPECT_TRUE(run_sweep(config(), options("a")).complete);
  EXPECT_EQ(tables("a"), tables("whole"));
}

TEST_F(SweepRun, KilledAtAnyMomentItGoesOn) {
  const SweepConfig sweep = config();
  run_sweep(sweep, options("whole"));
  for (int kill_number = 0; kill_number < 6; ++kill_number) {
    ChildProcess killed([&] { return run_sweep(sweep, options("a")).complete ? 0 : 1; });
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + 40 * kill_number));
    killed.send(SIGKILL);
    killed.wait();
  }
  EXPECT_TRUE(run_sweep(sweep, options("a")).complete);
  EXPECT_EQ(tables("a"), tables("whole"));
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "a" / "tasks"))
    EXPECT_NE(entry.path().extension(), ".tmp");
}

TEST_F(SweepRun, DamagedAnswersAreSolvedAgain) {
  run_sweep(config(), options("a"));
  const std::string first = tables("a");
  const fs::path pack = fs::directory_iterator(folder_ / "a" / "packs")->path();
  fs::resize_file(pack, fs::file_size(pack) - 10);
  const SweepRows rows = load_sweep_rows(folder_ / "a");
  EXPECT_TRUE(rows.rows.empty());
  folder_.write("a/tasks/" + rows.tasks[1].key + "/ml.json", "{\"format\": \"rigproof-sweep-ans");
  SweepOptions fresh_cache = options("a");
  fresh_cache.cache = folder_ / "other";
  EXPECT_EQ(run_sweep(config(), fresh_cache).counters.at("answers solved"), 8U);
  EXPECT_EQ(tables("a"), first);
}

TEST_F(SweepRun, TwoSweepsInOneFolderAreRefused) {
  const FolderLock lock(folder_ / "a", "");
  try {
    run_sweep(config(), options("a"));
    FAIL() << "worked beside another";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
    EXPECT_THAT(error.what(), HasSubstr("another rigproof sweeps in this folder"));
  }
}

TEST_F(SweepRun, TellsHowFarItIs) {
  EXPECT_THAT(error_text([&] { sweep_state(folder_ / "nowhere"); }), HasSubstr("nowhere: is not there"));
  EXPECT_THAT(error_text([&] { sweep_state(folder_.path()); }), HasSubstr("holds no sweep"));
  run_sweep(config(), options("a"));
  const SweepState state = sweep_state(folder_ / "a");
  EXPECT_EQ(state.answers, 8U);
  EXPECT_EQ(state.answers_there, 8U);
  EXPECT_FALSE(state.running);
  EXPECT_EQ(state.counters.at("answers solved"), 8U);
  EXPECT_EQ(sweep_config_file(folder_ / "a"), folder_ / "a" / "sweep.yaml");
  const SweepConfig resumed = load_sweep_config(sweep_config_file(folder_ / "a"));
  EXPECT_EQ(run_sweep(resumed, options("a")).counters.at("answers already there"), 8U);
}

TEST_F(SweepRun, StopsAreTheFirstOfTheDrive) {
  const std::string text = R"(
mode: geometric
run: {poses: 20}
axes: {count: {field: images, values: [6, 20]}}
methods: [ml]
)";
  run_sweep(config(text), options("a"));
  gather_sweep(folder_ / "a");
  std::map<std::string, double> bound;
  for (const SweepRow& row : load_sweep_rows(folder_ / "a").rows)
    if (row.camera == "left") bound[row.levels[0]] = row.bound[0].value_or(0.0);
  EXPECT_GT(bound["6"], bound["20"]) << "fewer stops say less";
  EXPECT_GT(bound["20"], 0.0);
}

}  // namespace
}  // namespace rigproof
