// Errors of lenses, board and depth that last from day to day: what the first day found of them, the second one knows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/plan/moved.h"
#include "rigproof/core/conventions.h"
#include "stranger.h"
#include "temp_folder.h"
#include "trials.h"

namespace rigproof {
namespace {

MovedOptions rigid_robot() {
  MovedOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  return options;
}

Result first_day(const Stranger& robot, std::uint64_t seed) {
  return ml_method().solve(drive(robot, 50000 + seed, 20).observations);
}

Observations second_day(const Stranger& robot, std::uint64_t seed, int stops) {
  return drive(robot, 60000 + seed, stops).observations;
}

// One that has its center camera shifted in the chart of transform_error().
Stranger knocked(Stranger robot, int axis, double size) {
  Rigid3& T = robot.config.rig.T_robot_camera[1];
  T = apply_transform_error(T, size * Vector6d::Unit(axis));
  return robot;
}

bool only_center_moved(const MovedReport& report) {
  return report.outcome == MovedOutcome::kMoved && report.cameras[1].verdict == MovedVerdict::kMoved &&
         report.cameras[0].verdict != MovedVerdict::kMoved && report.cameras[2].verdict != MovedVerdict::kMoved;
}

// 2 mm of height and .1 deg of roll are less than what lenses, board and depth leave open of a day by itself.
TEST(LastingErrors, HideNoShiftOverTrials) {
  const int count = Trials(5, 25).count();
  int higher = 0, rolled = 0, alone = 0;
  for (int trial = 0; trial < count; ++trial) {
    const Stranger robot = draw_stranger(trial);
    const auto seed = static_cast<std::uint64_t>(trial);
    Result before = first_day(robot, seed);
    ASSERT_TRUE(before.lasting) << trial;
    const Observations risen = second_day(knocked(robot, 2, 0.002), seed, 2);
    higher += only_center_moved(detect_movement(before, risen, rigid_robot()));
    rolled += only_center_moved(
        detect_movement(before, second_day(knocked(robot, 3, deg_to_rad(0.1)), seed, 2), rigid_robot()));
    before.lasting.reset();
    alone += only_center_moved(detect_movement(before, risen, rigid_robot()));
  }
  EXPECT_GE(higher, 0.9 * count);
  EXPECT_GE(rolled, 0.9 * count);
  EXPECT_LE(alone, 0.3 * count);
}

TEST(LastingErrors, AreReadAsTheyWereWritten) {
  const TempFolder folder;
  const Stranger robot = draw_stranger(3);
  const Result before = first_day(robot, 3);
  save_result(before, folder / "ml.yaml");
  const Result read = load_result(folder / "ml.yaml");
  const Observations today = second_day(robot, 3, 3);
  const MovedReport of_memory = detect_movement(before, today, rigid_robot());
  const MovedReport of_file = detect_movement(read, today, rigid_robot());
  EXPECT_NEAR(of_file.statistic, of_memory.statistic, 1e-4 * of_memory.statistic);
  EXPECT_EQ(of_file.degrees_of_freedom, of_memory.degrees_of_freedom);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(of_file.cameras[c].detectable_shift_m, of_memory.cameras[c].detectable_shift_m,
                1e-4 * of_memory.cameras[c].detectable_shift_m);
}

// A sheet that was printed anew is larger by one percent.
TEST(LastingErrors, AnotherBoardIsSuspectedBesideTheCameras) {
  int doubted = 0;
  MovedOptions options = rigid_robot();
  options.significance = 0.01;
  for (int trial = 0; trial < 4; ++trial) {
    Stranger robot = draw_stranger(trial);
    const Result before = first_day(robot, static_cast<std::uint64_t>(trial));
    const Board& board = robot.config.rig.board;
    for (int id = 0; id < board.corner_count(); ++id)
      robot.config.rig.print_errors_m[static_cast<std::size_t>(id)] += 0.01 * (board.corner(id) - board.centre());
    const MovedReport report =
        detect_movement(before, second_day(robot, static_cast<std::uint64_t>(trial), 5), options);
    for (const CameraShift& camera : report.cameras) EXPECT_NE(camera.verdict, MovedVerdict::kMoved) << trial;
    doubted += has_code(report.reasons, "moved.or_board");
  }
  EXPECT_GE(doubted, 3);
}

TEST(LastingErrors, OfALensThatIsStatedAnewCountNoMore) {
  const Stranger robot = draw_stranger(1);
  const Result before = first_day(robot, 1);
  Observations today = second_day(robot, 1, 3);
  const auto note_of = [&] {
    for (const Finding& note : detect_movement(before, today, rigid_robot()).notes)
      if (note.is("moved.stated_otherwise")) return note;
    return Finding("stated");
  };
  EXPECT_TRUE(note_of().is("stated"));
  today.cameras[2].camera.fx_px *= 1.001;
  const Finding of_lens = note_of();
  ASSERT_TRUE(of_lens.is("moved.stated_otherwise"));
  EXPECT_EQ(of_lens.cameras, std::vector<std::string>{today.cameras[2].name});
  EXPECT_EQ(of_lens.find("board"), nullptr);
  today.board.marker_m = 0.05;
  EXPECT_NE(note_of().find("board"), nullptr);
}

TEST(LastingErrors, AreNoneWhereAllIsBelieved) {
  GeometricConfig config;
  config.stops = 12;
  EXPECT_FALSE(ml_method().solve(draw_geometric_run(config).observations).lasting);
}

}  // namespace
}  // namespace rigproof
