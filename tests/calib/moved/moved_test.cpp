#include "rigproof/calib/plan/moved.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_text.h"
#include "past_boards.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/geometric/geometric.h"
#include "stranger.h"
#include "trials.h"
#include "turning_robot.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A calibration of the reference rig.
Result calibrated(std::uint64_t seed, int stops = 20) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = stops;
  return ml_method().solve(draw_geometric_run(config).observations);
}

// A few stops of another day; camera `moved` (-1: none) has shifted by `shift` in the chart of transform_error().
Observations another_day(std::uint64_t seed, int stops, int moved = -1, const Vector6d& shift = Vector6d::Zero()) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = stops;
  if (moved >= 0) {
    Rigid3& T = config.rig.T_robot_camera[static_cast<std::size_t>(moved)];
    T = apply_transform_error(T, shift);
  }
  return draw_geometric_run(config).observations;
}

// The geometric mode has no suspension.
MovedOptions rigid_robot() {
  MovedOptions options;
  options.suspension_height_sigma_m = 0.0;
  options.suspension_tilt_sigma_rad = 0.0;
  return options;
}

Vector6d shift_of(int axis, double size) { return size * Vector6d::Unit(axis); }

TEST(Moved, FalseAlarmsAreAsRareAsStatedOverTrials) {
  MovedOptions options = rigid_robot();
  options.significance = 0.05;
  const int count = Trials(60, 300).count();
  for (const int stops : {1, 2}) {
    int alarms = 0, rare = 0;
    double statistic = 0.0, dof = 0.0;
    for (int trial = 0; trial < count; ++trial) {
      // A previous calibration of its own each time: its error is part of what the test allows for.
      const std::uint64_t seed = 100 + static_cast<std::uint64_t>(trial);
      const MovedReport report = detect_movement(calibrated(20000 + seed, 12), another_day(seed, stops), options);
      alarms += report.outcome == MovedOutcome::kMoved ? 1 : 0;
      rare += report.p_value < 0.01 ? 1 : 0;
      statistic += report.statistic / count;
      dof += static_cast<double>(report.degrees_of_freedom) / count;
    }
    // Of 300 trials 15 are expected, with a standard deviation of 3.8; four of them.
    EXPECT_NEAR(alarms, 0.05 * count, 4.0 * std::sqrt(0.05 * 0.95 * count)) << stops << " stops";
    EXPECT_GE(alarms, count / 150) << stops << " stops";
    // 3 of 300; more than 9 come by chance once in a thousand. The tail is where a wrong linearisation shows.
    EXPECT_LE(rare, 0.01 * count + 3.5 * std::sqrt(0.01 * count)) << stops << " stops";
    // The mean of chi-square, to four of its standard deviations.
    EXPECT_NEAR(statistic / dof, 1.0, 4.0 * std::sqrt(2.0 / dof / count)) << stops << " stops";
  }
}

TEST(Moved, NamesTheCameraAndHowFar) {
  const Result previous = calibrated(1);
  for (int camera = 0; camera < 3; ++camera) {
    for (int axis = 0; axis < 6; ++axis) {
      const double size = axis < 3 ? 0.01 : deg_to_rad(0.3);
      const MovedReport report =
          detect_movement(previous, another_day(7, 2, camera, shift_of(axis, size)), rigid_robot());
      ASSERT_EQ(report.outcome, MovedOutcome::kMoved)
          << camera << kDegreeOfFreedomNames[static_cast<std::size_t>(axis)];
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(report.cameras[c].verdict == MovedVerdict::kMoved, static_cast<int>(c) == camera)
            << report.cameras[c].camera << " " << moved_verdict_name(report.cameras[c].verdict) << " axis " << axis;
      for (const CameraShift& stands : report.cameras)
        for (std::size_t i = 0; i < 6 && stands.verdict == MovedVerdict::kStands; ++i)
          // 432 estimates: five sigma come by chance once in 4,000 of these tests.
          EXPECT_LT(std::abs(*stands.shift[i]), 5.0 * *stands.sigma[i]) << stands.camera << " beside " << camera;
      const CameraShift& guilty = report.cameras[static_cast<std::size_t>(camera)];
      ASSERT_TRUE(guilty.shift[static_cast<std::size_t>(axis)].has_value());
      // 36 estimates: the largest of so many lies within four sigma but for one case in 400.
      EXPECT_NEAR(*guilty.shift[static_cast<std::size_t>(axis)], size,
                  4.0 * *guilty.sigma[static_cast<std::size_t>(axis)]);
    }
  }
}

// The camera that was moved sees another board than the two that stand.
TEST(Moved, IsToldByWhicheverBoardACameraSees) {
  const Result previous = ml_method().solve(PastTwoBoards(31, 40).drawn().observations);
  ASSERT_EQ(previous.status, ResultStatus::kSolved);
  int false_alarms = 0;
  for (std::uint64_t seed = 40; seed < 46; ++seed) {
    PastTwoBoards stands(seed, 12), moved(seed, 12);
    Rigid3& T = moved.config.rig.T_robot_camera[2];
    T = apply_transform_error(T, shift_of(1, 0.03));
    const auto outcome = [&](PastTwoBoards* day) {
      return detect_movement(previous, day->drawn().observations, rigid_robot());
    };
    false_alarms += outcome(&stands).outcome == MovedOutcome::kMoved;
    const MovedReport report = outcome(&moved);
    ASSERT_EQ(report.outcome, MovedOutcome::kMoved) << seed;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(report.cameras[c].verdict == MovedVerdict::kMoved, c == 2) << report.cameras[c].camera << seed;
  }
  EXPECT_EQ(false_alarms, 0);
}

// Their lenses, board and depth differ from what is stated, and so do the fields of their lenses, on both days alike.
TEST(Moved, RobotsOfStrangersRaiseNoMoreAlarmsOverTrials) {
  constexpr double kLevel = 0.01;
  const int count = Trials(10, 50).count();
  for (const double corner_sigma_px : {0.1, 0.02, 0.006}) {  // of noisy images, good ones, and simulated ones
    int alarms = 0, named = 0;
    for (int trial = 0; trial < count; ++trial) {
      Stranger robot = draw_stranger(trial, corner_sigma_px);
      const std::uint64_t seed = 100 + static_cast<std::uint64_t>(trial);
      const Result before = ml_method().solve(drive(robot, 30000 + seed, 20).observations);
      const auto report = [&] {
        return detect_movement(before, drive(robot, 40000 + seed, 5).observations, rigid_robot());
      };
      alarms += report().p_value < kLevel;
      Rigid3& T = robot.config.rig.T_robot_camera[1];
      T = apply_transform_error(T, shift_of(2, 0.02));
      const MovedReport knocked = report();
      named += knocked.outcome == MovedOutcome::kMoved && knocked.cameras[1].verdict == MovedVerdict::kMoved &&
               knocked.cameras[0].verdict != MovedVerdict::kMoved && knocked.cameras[2].verdict != MovedVerdict::kMoved;
    }
    // One in ten where new corners were believed to err by chance alone.
    EXPECT_LE(alarms, kLevel * count + 2.0 * std::sqrt(kLevel * (1.0 - kLevel) * count)) << corner_sigma_px;
    EXPECT_GE(named, 0.9 * count) << corner_sigma_px;
  }
}

TEST(Moved, SaysOfWhichCameraCornersScatterOtherwiseThanStated) {
  Observations today = another_day(1, 3);
  for (BoardView& view : today.board_views)
    for (CornerObservation& corner : view.corners)
      if (view.camera == 1) corner.covariance_px2 /= 9.0;
  const std::vector<Finding> notes = detect_movement(calibrated(20001, 12), today, rigid_robot()).notes;
  std::vector<Finding> scatter;
  for (const Finding& note : notes)
    if (note.is("moved.scatter_believed")) scatter.push_back(note);
  ASSERT_EQ(scatter.size(), 1U);
  EXPECT_EQ(scatter[0].cameras, std::vector<std::string>{"center"});
  EXPECT_NEAR(std::get<double>(scatter[0].find("times")->value), 3.0, 0.6);
}

// A shift of a hundred standard deviations leaves, beside what it explains, the noise of those that stand.
TEST(Moved, OthersAreAccusedAsRarelyAsStatedOverTrials) {
  MovedOptions options = rigid_robot();
  options.significance = 0.05;
  const int count = Trials(60, 300).count();
  int accused = 0;
  for (int trial = 0; trial < count; ++trial) {
    const std::uint64_t seed = 100 + static_cast<std::uint64_t>(trial);
    const int axis = trial % 6;
    const Vector6d shift = shift_of(axis, axis < 3 ? 0.02 : 0.01);
    const MovedReport report = detect_movement(calibrated(20000 + seed, 12), another_day(seed, 2, 1, shift), options);
    ASSERT_EQ(report.outcome, MovedOutcome::kMoved) << trial;
    const bool others =
        report.cameras[0].verdict == MovedVerdict::kMoved || report.cameras[2].verdict == MovedVerdict::kMoved;
    accused += others ? 1 : 0;
  }
  EXPECT_NEAR(accused, 0.05 * count, 4.0 * std::sqrt(0.05 * 0.95 * count));
}

TEST(Moved, TwoCamerasMayMove) {
  const Result previous = calibrated(1);
  GeometricConfig config;
  config.seed = 8;
  config.stops = 3;
  config.rig.T_robot_camera[0] = apply_transform_error(config.rig.T_robot_camera[0], shift_of(2, 0.02));
  config.rig.T_robot_camera[2] = apply_transform_error(config.rig.T_robot_camera[2], shift_of(4, 0.02));
  const MovedReport report = detect_movement(previous, draw_geometric_run(config).observations, rigid_robot());
  EXPECT_EQ(report.cameras[0].verdict, MovedVerdict::kMoved);
  EXPECT_EQ(report.cameras[1].verdict, MovedVerdict::kStands);
  EXPECT_EQ(report.cameras[2].verdict, MovedVerdict::kMoved);
}

TEST(Moved, TheRigAsAWholeIsOneBody) {
  const Result previous = calibrated(1);
  GeometricConfig config;
  config.seed = 9;
  config.stops = 2;
  const Rigid3 sunk(so3_exp({0.0, 0.01, 0.0}), {0.0, 0.0, -0.02});  // a soft tyre
  for (Rigid3& T : config.rig.T_robot_camera) T = sunk * T;
  const MovedReport report = detect_movement(previous, draw_geometric_run(config).observations, rigid_robot());
  EXPECT_EQ(report.outcome, MovedOutcome::kMoved);
  EXPECT_TRUE(report.rig_moved);
  EXPECT_THAT(worded(report.reasons), Contains("All cameras moved together, as one body: the rig on the robot."));
}

// One stop leaves x, y and yaw of the rig open: a turn of a radian, at poses that are millimetres off, seemed to
// explain what one camera did.
TEST(Moved, WhatOneCameraDidIsNoTurnOfTheRig) {
  const Result previous = calibrated(1);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const MovedReport report =
        detect_movement(previous, another_day(5000000 + seed, 1, 1, shift_of(1, 0.004)), rigid_robot());
    EXPECT_EQ(report.cameras[1].verdict, MovedVerdict::kMoved) << seed;
    EXPECT_FALSE(report.rig_moved) << seed;
  }
}

// Of a rig that was pushed along the floor the odometry alone tells.
TEST(Moved, OdometryIsNamedBesideARigThatItAloneTellsOf) {
  GeometricConfig config;
  config.seed = 9;
  config.stops = 4;
  for (Rigid3& T : config.rig.T_robot_camera) T = Rigid3(so3_exp({0.0, 0.0, 0.02}), {0.0, 0.03, 0.0}) * T;
  const MovedReport report = detect_movement(calibrated(1), draw_geometric_run(config).observations, rigid_robot());
  EXPECT_TRUE(report.rig_moved);
  EXPECT_THAT(worded(report.reasons), Contains(HasSubstr("or the odometry errs by more than it states")));
}

// A calibration that does not know where its robot turns states 5 cm of x and y. The robot still turns there.
TEST(Moved, TheRobotTurnsWhereItDid) {
  GeometricConfig config;
  config.seed = 1;
  config.stops = 20;
  config.along_way = true;
  const auto drawn = [&config] {
    Observations observations = draw_geometric_run(config).observations;
    observations.odometry_noise = {};
    return observations;
  };
  const Result previous = ml_method().solve(drawn());
  ASSERT_TRUE(previous.joint_covariance);
  ASSERT_GT((*previous.joint_covariance)(0, 0), 0.05 * 0.05);
  config.seed = 9;
  config.stops = 24;
  EXPECT_EQ(detect_movement(previous, drawn(), rigid_robot()).outcome, MovedOutcome::kNothingMoved);
  for (Rigid3& T : config.rig.T_robot_camera) T.translation.x() += 0.08;
  const MovedReport report = detect_movement(previous, drawn(), rigid_robot());
  EXPECT_TRUE(report.rig_moved);
}

// A robot that turns about a point ahead of its origin, on one day or another.
struct TurningRobot {
  bool along_way = true;

  // @param turns_m and @param stated_m where it turns and where the rig says so, in the frame of its cameras
  Observations drawn(std::uint64_t seed, const Eigen::Vector2d& turns_m, const Eigen::Vector2d& stated_m,
                     std::optional<double> sigma_m) const {
    GeometricConfig config;
    config.seed = seed;
    config.stops = 20;
    config.along_way = along_way;
    for (Rigid3& T : config.rig.T_robot_camera) T.translation.head<2>() -= turns_m;
    Observations observations = draw_geometric_run(config).observations;
    observations.odometry_noise = {};
    return of_origin(observations, stated_m, sigma_m);
  }
};

Result calibrated_from(const Observations& observations) { return run_method(ml_method(), {observations}); }
MovedOutcome outcome(const Result& previous, const Observations& now) {
  return detect_movement(previous, now, rigid_robot()).outcome;
}

const Eigen::Vector2d kAhead_m(0.13, 0.02), kNotStated = Eigen::Vector2d::Zero();

// The same robot, of which somebody has measured since where it turns, or has forgotten it, or measures it anew; under
// another load it turns elsewhere. The cameras stand.
TEST(Moved, WhereTheRobotTurnsMayBeStatedLater) {
  const TurningRobot robot;
  const Eigen::Vector2d loaded_m(0.175, 0.02), off_m(0.012, -0.018);
  const Result unstated = calibrated_from(robot.drawn(1, kAhead_m, kNotStated, std::nullopt));
  const Result stated = calibrated_from(robot.drawn(1, kAhead_m, kAhead_m - off_m, 0.015));
  EXPECT_EQ(outcome(unstated, robot.drawn(9, kAhead_m, kAhead_m + off_m, 0.015)), MovedOutcome::kNothingMoved);
  EXPECT_EQ(outcome(stated, robot.drawn(9, kAhead_m, kNotStated, std::nullopt)), MovedOutcome::kNothingMoved);
  EXPECT_EQ(outcome(stated, robot.drawn(9, kAhead_m, kAhead_m + off_m, 0.015)), MovedOutcome::kNothingMoved);
  EXPECT_EQ(outcome(stated, robot.drawn(9, loaded_m, loaded_m + off_m, 0.015)), MovedOutcome::kNothingMoved);
  EXPECT_EQ(outcome(stated, robot.drawn(9, -kAhead_m, off_m - kAhead_m, 0.015)), MovedOutcome::kNothingMoved);
  const auto notes = [&stated](const Observations& now) { return detect_movement(stated, now, rigid_robot()).notes; };
  EXPECT_TRUE(has_code(notes(robot.drawn(9, loaded_m, loaded_m + off_m, 0.015)), "moved.turning_points_differ"));
  EXPECT_FALSE(has_code(notes(robot.drawn(9, kAhead_m, kAhead_m - off_m, 0.015)), "moved.turning_points_differ"));
  const Eigen::Vector2d pushed_m(0.2, 0.0);
  EXPECT_EQ(outcome(stated, robot.drawn(9, pushed_m - kAhead_m, -kAhead_m, 0.015)), MovedOutcome::kMoved);
}

// Odometry at the stops alone may be that of wheels or of a tracker, which is of the origin.
TEST(Moved, OdometryThatMayBeOfEitherPointAccusesNobody) {
  const TurningRobot robot{false};
  for (const Eigen::Vector2d& of_unstated : {kAhead_m, kNotStated}) {
    const Result unstated = calibrated_from(robot.drawn(1, of_unstated, kNotStated, std::nullopt));
    ASSERT_TRUE(unstated.joint_covariance);
    EXPECT_NE(outcome(unstated, robot.drawn(9, kAhead_m, kAhead_m, 0.005)), MovedOutcome::kMoved);
  }
}

// Of one stop at which all cameras see the board.
Observations one_stop(const Vector6d& shift = Vector6d::Zero()) {
  GeometricConfig config;
  config.seed = 7;
  config.stops = 1;
  config.rig.min_cameras_per_stop = 3;
  config.rig.T_robot_camera[1] = apply_transform_error(config.rig.T_robot_camera[1], shift);
  return draw_geometric_run(config).observations;
}

// One stop: cameras against each other and the ground; where the rig sits on the robot stays open, and is said to.
TEST(Moved, OneStopTellsCameraToCameraAndTheGround) {
  const Result previous = calibrated(1);
  const MovedOptions options = rigid_robot();
  const MovedReport still = detect_movement(previous, one_stop(), options);
  EXPECT_EQ(still.outcome, MovedOutcome::kNothingMoved);
  EXPECT_THAT(worded(still.notes),
              Contains(HasSubstr("A common shift of all cameras on the robot would not show in x, y, yaw")));
  const MovedReport moved = detect_movement(previous, one_stop(shift_of(1, 0.02)), options);
  EXPECT_EQ(moved.cameras[1].verdict, MovedVerdict::kMoved);
}

// Two cameras and no ground: which of them moved is open.
TEST(Moved, WithTwoCamerasBothAreSuspects) {
  GeometricConfig config;
  config.seed = 3;
  config.stops = 30;
  config.rig.cameras.resize(2);
  config.rig.T_robot_camera.resize(2);
  config.rig.min_cameras_per_stop = 2;
  const Result previous = ml_method().solve(draw_geometric_run(config).observations);
  config.seed = 4;
  config.stops = 1;
  config.ground = false;
  const MovedReport still = detect_movement(previous, draw_geometric_run(config).observations, rigid_robot());
  ASSERT_LT(still.cameras[1].detectable_shift_m, 0.04);
  const double shift_m = 1.5 * still.cameras[1].detectable_shift_m;
  config.rig.T_robot_camera[1] = apply_transform_error(config.rig.T_robot_camera[1], shift_of(0, shift_m));
  const MovedReport report = detect_movement(previous, draw_geometric_run(config).observations, rigid_robot());
  EXPECT_EQ(report.outcome, MovedOutcome::kMoved);
  EXPECT_EQ(report.cameras[0].verdict, MovedVerdict::kSuspect);
  EXPECT_EQ(report.cameras[1].verdict, MovedVerdict::kSuspect);
  EXPECT_THAT(worded(report.reasons), Contains(HasSubstr("do not tell which")));
}

TEST(Moved, OneCameraAtOneStopCannotBeTold) {
  GeometricConfig config;
  config.seed = 3;
  config.stops = 30;
  config.rig.cameras.resize(1);
  config.rig.T_robot_camera.resize(1);
  config.rig.min_cameras_per_stop = 1;
  const Result previous = ml_method().solve(draw_geometric_run(config).observations);
  config.stops = 1;
  const MovedReport report = detect_movement(previous, draw_geometric_run(config).observations, rigid_robot());
  EXPECT_EQ(report.outcome, MovedOutcome::kCannotTell);
  EXPECT_EQ(report.cameras[0].verdict, MovedVerdict::kCannotTell);
  EXPECT_TRUE(std::isinf(report.cameras[0].detectable_shift_m));
}

TEST(Moved, ACameraWithoutAnImageCannotBeTold) {
  const Result previous = calibrated(1);
  Observations day = another_day(7, 2);
  const auto of_right = [](const auto& item) { return item.camera == 2; };
  day.board_views.erase(std::remove_if(day.board_views.begin(), day.board_views.end(), of_right),
                        day.board_views.end());
  day.ground_planes.erase(std::remove_if(day.ground_planes.begin(), day.ground_planes.end(), of_right),
                          day.ground_planes.end());
  const MovedReport report = detect_movement(previous, day, rigid_robot());
  EXPECT_EQ(report.outcome, MovedOutcome::kCannotTell);
  EXPECT_EQ(report.cameras[0].verdict, MovedVerdict::kStands);
  EXPECT_EQ(report.cameras[2].verdict, MovedVerdict::kCannotTell);
}

// A partial previous result: after a straight drive the cameras are known in each other alone.
TEST(Moved, CameraToCameraIsEnough) {
  GeometricConfig config;
  config.seed = 5;
  config.stops = 12;
  config.drive = GeometricDrive::kStraight;
  const Result previous = ml_method().solve(draw_geometric_run(config).observations);
  ASSERT_EQ(previous.status, ResultStatus::kPartial);
  const MovedOptions options = rigid_robot();
  const MovedReport still = detect_movement(previous, another_day(7, 4), options);
  EXPECT_EQ(still.outcome, MovedOutcome::kNothingMoved);
  EXPECT_THAT(worded(still.notes), Contains(HasSubstr("only the poses between cameras")));
  const MovedReport moved = detect_movement(previous, another_day(7, 4, 1, shift_of(1, 0.03)), options);
  EXPECT_EQ(moved.cameras[1].verdict, MovedVerdict::kMoved);
}

// What is wrong with the odometry of a day on which nothing moved.
struct WrongOdometry {
  const char* name;
  void (*spoil)(Observations*);
  const char* cause;
};

class MovedByOdometry : public testing::TestWithParam<WrongOdometry> {};

TEST_P(MovedByOdometry, NothingHas) {
  const Result previous = calibrated(1);
  int named = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Observations day = another_day(seed, 3);
    GetParam().spoil(&day);
    // Declared noise may bend the corners before it gives way: then it is refused.
    EXPECT_NE(detect_movement(previous, day, rigid_robot()).outcome, MovedOutcome::kMoved) << seed;
    day.odometry_noise = {};
    const MovedReport report = detect_movement(previous, day, rigid_robot());
    EXPECT_EQ(report.outcome, MovedOutcome::kNothingMoved) << seed << ": " << testing::PrintToString(report.reasons);
    EXPECT_THAT(worded(report.notes), Contains(HasSubstr("The odometry is ignored because it contradicts the images")))
        << seed;
    for (const std::string& note : worded(report.notes))
      named += note.find(GetParam().cause) != std::string::npos ? 1 : 0;
    EXPECT_THAT(worded(report.notes),
                Contains(HasSubstr("A common shift of all cameras on the robot would not show in x, y, yaw")));
  }
  EXPECT_GE(named, 3);  // of four: bent images may hide the unit
  // The images alone still tell which camera did.
  Observations day = another_day(7, 3, 1, shift_of(1, 0.01));
  GetParam().spoil(&day);
  day.odometry_noise = {};
  const MovedReport moved = detect_movement(previous, day, rigid_robot());
  EXPECT_EQ(moved.outcome, MovedOutcome::kMoved);
  EXPECT_EQ(moved.cameras[1].verdict, MovedVerdict::kMoved);
}

INSTANTIATE_TEST_SUITE_P(Drives, MovedByOdometry,
                         testing::Values(WrongOdometry{"millimetres",
                                                       [](Observations* day) {
                                                         for (Stop& stop : day->stops) {
                                                           stop.x_m *= 1000.0;
                                                           stop.y_m *= 1000.0;
                                                         }
                                                       },
                                                       "millimetres"},
                                         WrongOdometry{"yaw_of_the_wrong_sign",
                                                       [](Observations* day) {
                                                         for (Stop& stop : day->stops) stop.yaw_rad *= -1.0;
                                                       },
                                                       "wrong sign"}),
                         [](const auto& drive) { return std::string(drive.param.name); });

// Odometry in millimetres, its noise declared in metres, tore the poses of this day apart until nothing held them.
TEST(Moved, PosesThatAreTornApartAreNoMotion) {
  Observations day = another_day(156, 3);
  for (Stop& stop : day.stops) {
    stop.x_m *= 1000.0;
    stop.y_m *= 1000.0;
  }
  const MovedReport report = detect_movement(calibrated(1), day, rigid_robot());
  EXPECT_NE(report.outcome, MovedOutcome::kMoved);
  for (const CameraShift& camera : report.cameras) {
    EXPECT_NE(camera.verdict, MovedVerdict::kMoved) << camera.camera;
    EXPECT_NE(camera.verdict, MovedVerdict::kSuspect) << camera.camera;
  }
}

TEST(Moved, ABoardOfAnotherSizeIsRefusedWithItsCause) {
  const Result previous = calibrated(1);
  GeometricConfig config;
  config.seed = 7;
  config.stops = 3;
  config.board_planes = true;
  Observations day = draw_geometric_run(config).observations;
  EXPECT_EQ(detect_movement(previous, day, rigid_robot()).outcome, MovedOutcome::kNothingMoved);
  day.board.square_m *= 1.1;
  const MovedReport report = detect_movement(previous, day, rigid_robot());
  EXPECT_EQ(report.outcome, MovedOutcome::kCannotTell);
  EXPECT_THAT(worded(report.reasons), Contains(HasSubstr("the board's size")));
  for (const CameraShift& camera : report.cameras) EXPECT_EQ(camera.verdict, MovedVerdict::kCannotTell);
}

TEST(Moved, RefusesWhatStatesNoUncertainty) {
  Result previous = calibrated(1);
  for (EstimatedTransform& T : previous.camera_to_robot) T.covariance.reset();
  for (EstimatedTransform& T : previous.camera_to_camera) T.covariance.reset();
  EXPECT_THAT(error_text([&] { detect_movement(previous, another_day(7, 2)); }), HasSubstr("states no uncertainty"));
  Observations others = another_day(7, 2);
  for (RigCamera& camera : others.cameras) camera.name += "_other";
  EXPECT_THAT(error_text([&] { detect_movement(calibrated(1), others); }), HasSubstr("none of the observed cameras"));
  MovedOptions options;
  options.significance = 0.0;
  EXPECT_THAT(error_text([&] { detect_movement(calibrated(1), another_day(7, 2), options); }),
              HasSubstr("significance"));
}

}  // namespace
}  // namespace rigproof
