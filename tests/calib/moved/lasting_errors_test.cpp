// Errors of lenses, board and depth that last from day to day: what the first day found of them, the second one knows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/plan/moved.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
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

// 4 mm of height and .1 deg of roll are about what lenses, board and depth leave open of a day by itself.
TEST(LastingErrors, HideNoShiftOverTrials) {
  const int count = Trials(5, 25).count();
  int higher = 0, rolled = 0, alone = 0;
  for (int trial = 0; trial < count; ++trial) {
    const Stranger robot = draw_stranger(trial);
    const auto seed = static_cast<std::uint64_t>(trial);
    Result before = first_day(robot, seed);
    ASSERT_TRUE(before.lasting) << trial;
    const Observations risen = second_day(knocked(robot, 2, 0.004), seed, 2);
    higher += only_center_moved(detect_movement(before, risen, rigid_robot()));
    rolled += only_center_moved(
        detect_movement(before, second_day(knocked(robot, 3, deg_to_rad(0.1)), seed, 2), rigid_robot()));
    before.lasting.reset();
    const MovedReport forgotten = detect_movement(before, risen, rigid_robot());
    EXPECT_TRUE(has_code(forgotten.notes, "moved.errors_forgotten"));
    alone += only_center_moved(forgotten);
  }
  EXPECT_GE(higher, 0.9 * count);
  EXPECT_GE(rolled, 0.9 * count);
  EXPECT_LE(alone, 0.5 * count);
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

// A lens of which focal length (relative) and principal point [px] are other ones than on the first day.
Stranger with_other_lens(Stranger robot, std::size_t camera, double focal, const Eigen::Vector2d& centre_px) {
  Camera& lens = robot.config.rig.cameras[camera].camera;
  lens.fx_px *= 1.0 + focal;
  lens.fy_px *= 1.0 + focal;
  lens.cx_px += centre_px.x();
  lens.cy_px += centre_px.y();
  robot.lens[camera].head<3>() += Eigen::Vector3d(focal, centre_px.x(), centre_px.y());
  return robot;
}

// By as much as lenses and depth are said to drift.
TEST(LastingErrors, WarmthAccusesNobodyOverTrials) {
  constexpr double kLevel = 0.01;
  const int count = Trials(6, 40).count();
  int alarms = 0;
  for (int trial = 0; trial < count; ++trial) {
    Stranger robot = draw_stranger(trial);
    const auto seed = static_cast<std::uint64_t>(trial);
    const Result before = first_day(robot, seed);
    RandomStream random(seed, "warmth");
    for (std::size_t c = 0; c < 3; ++c) {
      const double focal = random.normal(0.0, 2e-4), x = random.normal(0.0, 0.1), y = random.normal(0.0, 0.1);
      robot = with_other_lens(robot, c, focal, {x, y});
      robot.config.depth_scales[c] *= 1.0 + random.normal(0.0, 5e-4);
    }
    alarms += detect_movement(before, second_day(robot, seed, 3), rigid_robot()).p_value < kLevel;
  }
  EXPECT_LE(alarms, kLevel * count + 2.0 * std::sqrt(kLevel * (1.0 - kLevel) * count));
}

// Half a percent of focal length: the right camera is named, and its lens beside it.
TEST(LastingErrors, ALensThatWasFocusedAnewIsSaidBesideItsCamera) {
  int named = 0, doubted = 0;
  const int count = 4;
  for (int trial = 0; trial < count; ++trial) {
    const Stranger robot = draw_stranger(trial);
    const auto seed = static_cast<std::uint64_t>(trial);
    const Result before = first_day(robot, seed);
    const MovedReport report = detect_movement(
        before, second_day(with_other_lens(robot, 1, 0.005, Eigen::Vector2d::Zero()), seed, 5), rigid_robot());
    if (!only_center_moved(report)) continue;
    ++named;
    doubted += has_code(report.reasons, "moved.or_lens");
  }
  EXPECT_GE(named, 3);
  EXPECT_GE(doubted, named - 1);
}

// A camera that moved by far is no lens.
TEST(LastingErrors, AFarMoveIsOfNoLens) {
  const Stranger robot = draw_stranger(1);
  const MovedReport report =
      detect_movement(first_day(robot, 1), second_day(knocked(robot, 2, 0.05), 1, 3), rigid_robot());
  EXPECT_TRUE(only_center_moved(report));
  EXPECT_FALSE(has_code(report.reasons, "moved.or_lens"));
}

TEST(LastingErrors, OfALensThatIsStatedAnewCountNoMore) {
  const Stranger robot = draw_stranger(1);
  const Result before = first_day(robot, 1);
  Observations today = second_day(robot, 1, 3);
  const auto notes = [&] { return detect_movement(before, today, rigid_robot()).notes; };
  EXPECT_FALSE(has_code(notes(), "moved.camera_otherwise"));
  today.cameras[2].camera.fx_px *= 1.001;
  const std::vector<Finding> of_lens = notes();
  ASSERT_TRUE(has_code(of_lens, "moved.camera_otherwise"));
  for (const Finding& note : of_lens)
    if (note.is("moved.camera_otherwise")) {
      EXPECT_EQ(note.cameras, std::vector<std::string>{today.cameras[2].name});
    }
  EXPECT_FALSE(has_code(of_lens, "moved.board_otherwise"));
  today.board.marker_m = 0.05;
  EXPECT_TRUE(has_code(notes(), "moved.board_otherwise"));
}

TEST(LastingErrors, AreNoneWhereAllIsBelieved) {
  GeometricConfig config;
  config.stops = 12;
  EXPECT_FALSE(ml_method().solve(draw_geometric_run(config).observations).lasting);
}

// What is believed today needs nothing of what was found then.
TEST(LastingErrors, CountOnlyWhereTheyAreDoubtedToday) {
  const Result before = first_day(draw_stranger(2), 2);
  ASSERT_TRUE(before.lasting);
  GeometricConfig config;
  config.stops = 3;
  Observations today = draw_geometric_run(config).observations;
  for (std::size_t c = 0; c < today.cameras.size(); ++c) today.cameras[c].name = before.camera_to_robot[c].child;
  const MovedReport report = detect_movement(before, today, rigid_robot());
  EXPECT_GT(report.degrees_of_freedom, 0);
  EXPECT_TRUE(std::isfinite(report.statistic));
}

}  // namespace
}  // namespace rigproof
