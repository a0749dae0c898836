// Li, RobotAutocalib and OpenCV's solvers: exact where they can be, in words where they cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "board_drive.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

std::string text(const std::vector<Finding>& findings) { return testing::PrintToString(worded(findings)); }

SyntheticDrive noisy_drive(std::uint64_t seed, int stops) {
  DriveOptions options;
  options.seed = seed;
  options.stops = stops;
  options.corner_sigma_px = 0.05;
  options.odometry_sigma_m = 0.001;
  options.odometry_sigma_rad = 0.001;
  SyntheticDrive drive = make_drive(options);
  for (RigCamera& camera : drive.observations.cameras) camera.depth.emplace();
  return drive;
}

// ---------------------------------------------------------------------------------------------------------------- li

TEST(Li, IsExactOnExactCorners) {
  const SyntheticDrive drive = exact_drive(1);
  const Result result = find_method("li").solve(drive.observations);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_TRUE(result.camera_to_robot.empty());
  const WorstError error = worst_pair_error(result, drive);
  EXPECT_LT(error.distance_m, 1e-8);
  EXPECT_LT(error.angle_rad, 1e-8);
}

// Chi-square of 18 pairs' worth of six numbers: the mean of errors over stated sigmas squared is 1 within chance.
TEST(Li, StatesItsUncertainty) {
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SyntheticDrive drive = noisy_drive(seed, 15);
    const Result result = find_method("li").solve(drive.observations);
    ASSERT_EQ(result.status, ResultStatus::kSolved);
    for (std::size_t k = 1; k < 3; ++k) {
      const EstimatedTransform* pair = result.find("camera0", "camera" + std::to_string(k));
      ASSERT_NE(pair, nullptr);
      const Rigid3 truth = drive.T_robot_camera[0].inverse() * drive.T_robot_camera[k];
      const Vector6d error = transform_error(pair->T_parent_child, truth);
      sum += error.cwiseAbs2().cwiseQuotient(pair->covariance->diagonal()).sum();
      count += 6;
    }
  }
  // 144 correlated numbers: a factor of 1.7 either way is beyond chance.
  EXPECT_GT(sum / count, 0.6);
  EXPECT_LT(sum / count, 1.7);
}

TEST(Li, DoesNotNeedOdometryOrGround) {
  SyntheticDrive drive = exact_drive(2);
  for (Stop& stop : drive.observations.stops) stop.x_m = stop.y_m = stop.yaw_rad = 0.0;
  drive.observations.ground_planes.clear();
  EXPECT_LT(worst_pair_error(find_method("li").solve(drive.observations), drive).distance_m, 1e-8);
}

TEST(Li, ShrugsOffAFlippedOrForeignBoard) {
  SyntheticDrive drive = noisy_drive(3, 20);
  const WorstError clean = worst_pair_error(find_method("li").solve(drive.observations), drive);
  for (const std::size_t i : {4u, 17u})
    for (CornerObservation& corner : drive.observations.board_views[i].corners) corner.pixel.x() += 25.0;
  const Result result = find_method("li").solve(drive.observations);
  const WorstError error = worst_pair_error(result, drive);
  EXPECT_LT(error.distance_m, 2.0 * clean.distance_m + 1e-4);
  EXPECT_LT(error.angle_rad, 2.0 * clean.angle_rad + 1e-4);
  std::size_t left_out = 0;
  for (const CameraUse& use : result.use) left_out += use.left_out.size();
  EXPECT_GE(left_out, 2U);
}

// A chain 0-1-2 joins cameras that never see the board together.
TEST(Li, JoinsCamerasThroughOthers) {
  SyntheticDrive drive = exact_drive(4, 24);
  keep_views([](int stop, int camera) { return stop % 2 == 0 ? camera != 2 : camera != 0; }, &drive);
  const Result result = find_method("li").solve(drive.observations);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
  EXPECT_LT(worst_pair_error(result, drive).distance_m, 1e-8);
}

TEST(Li, NamesCamerasThatNothingJoins) {
  SyntheticDrive drive = exact_drive(5, 24);
  keep_views([](int stop, int camera) { return stop % 2 == 0 ? camera < 2 : camera == 2; }, &drive);
  const Result result = find_method("li").solve(drive.observations);
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  EXPECT_THAT(text(result.reasons), HasSubstr("{camera0 and camera1} and {camera2}"));
  ASSERT_EQ(result.camera_to_camera.size(), 1U);
  EXPECT_NE(result.find("camera0", "camera1"), nullptr);
  keep_views([](int stop, int camera) { return stop % 2 == 0 ? camera == 0 : camera == 2; }, &drive);
  const MethodInput input{drive.observations};
  EXPECT_THAT(worded(find_method("li").why_not(input)), HasSubstr("without overlap"));
  const Result refused = run_method(find_method("li"), input);
  EXPECT_EQ(refused.status, ResultStatus::kRefused);
  EXPECT_EQ(refused.method, "li");
  EXPECT_THAT(text(refused.reasons), HasSubstr("without overlap"));
}

// ---------------------------------------------------------------------------------------------------- RobotAutocalib

TEST(RobotAutocalibBoard, IsExactOnExactData) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SyntheticDrive drive = exact_drive(seed);
    const Result result = find_method("robot_autocalib_board").solve(drive.observations);
    ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons);
    const WorstError error = worst_error(result, drive);
    EXPECT_LT(error.distance_m, 1e-5);
    EXPECT_LT(error.angle_rad, 1e-5);
    EXPECT_THAT(text(result.notes), testing::ContainsRegex("camera0.*: scale of its motions 1.00000 m a unit"));
  }
}

TEST(RobotAutocalibBoard, ReachesItsPublishedErrorsOnSmallNoise) {
  const SyntheticDrive drive = noisy_drive(4, 60);
  const WorstError error = worst_error(find_method("robot_autocalib_board").solve(drive.observations), drive);
  EXPECT_LT(error.distance_m, 0.01);
  EXPECT_LT(rad_to_deg(error.angle_rad), 0.5);
}

TEST(RobotAutocalibBoard, LeavesOutMotionsThatContradictTheOdometry) {
  SyntheticDrive drive = exact_drive(6, 30);
  // The robot was lifted: everything after stop 12 stands elsewhere in its odometry.
  for (std::size_t i = 12; i < drive.observations.stops.size(); ++i) drive.observations.stops[i].x_m += 1.5;
  const Result result = find_method("robot_autocalib_board").solve(drive.observations);
  EXPECT_LT(worst_error(result, drive).distance_m, 1e-4);
}

TEST(RobotAutocalibBoard, SaysWhatIsMissing) {
  SyntheticDrive drive = exact_drive(7);
  SyntheticDrive blind = drive;
  blind.observations.ground_planes.clear();
  EXPECT_THAT(worded(find_method("robot_autocalib_board").why_not({blind.observations})),
              HasSubstr("No camera has a ground plane"));
  DriveOptions straight;
  straight.kind = DriveKind::kStraight;
  const Result result = find_method("robot_autocalib_board").solve(make_drive(straight).observations);
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(text(result.reasons), HasSubstr("never turned"));
}

// ------------------------------------------------------------------------------------------------------------ OpenCV

std::vector<const Method*> opencv_methods() {
  std::vector<const Method*> methods;
  for (const Method* method : all_methods())
    if (method->traits().name.rfind("opencv_", 0) == 0) methods.push_back(method);
  EXPECT_EQ(methods.size(), 5U);
  return methods;
}

// All five are solvers for arms. With a robot that turns about one axis the height is not in the data; what each says
// of it differs, and none is near for every drive.
TEST(OpenCvHandEye, FailsOnPlanarMotionAndShowsIt) {
  for (const Method* method : opencv_methods()) {
    double worst_height_m = 0.0;
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const SyntheticDrive drive = exact_drive(seed);
      const Result result = run_method(*method, {drive.observations});
      if (result.status == ResultStatus::kRefused) {
        EXPECT_FALSE(result.reasons.empty());
        worst_height_m = 1.0;
        continue;
      }
      EXPECT_THAT(text(result.notes), HasSubstr("one axis only"));
      for (const EstimatedTransform& camera : result.camera_to_robot)
        EXPECT_TRUE(camera.T_parent_child.matrix().allFinite());
      worst_height_m = std::max(worst_height_m, worst_error(result, drive).height_m);
    }
    EXPECT_GT(worst_height_m, 0.1) << method->traits().name;
  }
}

TEST(OpenCvHandEye, SaysWhatIsMissing) {
  SyntheticDrive drive = exact_drive(1);
  keep_views([](int stop, int /*camera*/) { return stop < 2; }, &drive);
  for (const Method* method : opencv_methods()) {
    EXPECT_THAT(worded(method->why_not({drive.observations})), HasSubstr("three stops"));
    EXPECT_EQ(method->solve(drive.observations).status, ResultStatus::kRefused);
  }
}

}  // namespace
}  // namespace rigproof
