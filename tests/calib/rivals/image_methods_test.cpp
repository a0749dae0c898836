// Methods that see features: on images of a patterned room whose truth is exact.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "rigproof/calib/feature_source.h"
#include "rigproof/calib/ground_source.h"
#include "rigproof/calib/rivals.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "room.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

std::string text(const std::vector<std::string>& lines) { return testing::PrintToString(lines); }

std::vector<Rigid3> straight_and_turns() {
  Steps steps(planar_pose(-2.0, -0.8, 0.1));
  steps.forward(0.15, 5);
  steps.arc(0.12, 9.0, 4);
  steps.forward(-0.15, 3);
  steps.arc(0.12, -9.0, 5);
  return steps.poses;
}

double angle_deg(const EstimatedTransform& estimate, const Rigid3& truth) {
  return rad_to_deg(transform_error(estimate.T_parent_child, truth).tail<3>().norm());
}

TEST(SensorX2Car, FindsTheRotationOfForwardAndSideCameras) {
  const TempFolder folder;
  const RoomDrive drive = drive_through_room(straight_and_turns(), two_cameras(), false, folder.path());
  const MethodInput input{drive.observations, &drive.recording, 2};
  EXPECT_EQ(sensorx2car_method().why_not(input), "");
  const Result result = run_method(sensorx2car_method(), input);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  ASSERT_EQ(result.camera_to_robot.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const EstimatedTransform& camera = result.camera_to_robot[k];
    EXPECT_FALSE(camera.observable[0] || camera.observable[1] || camera.observable[2]);
    // The published mean error is 0.26, 0.82 and 1.22 degrees about the three axes.
    EXPECT_LT(angle_deg(camera, drive.T_robot_camera[k]), 0.8) << text(result.notes);
  }
  ASSERT_EQ(result.camera_to_camera.size(), 1U);
  EXPECT_LT(angle_deg(result.camera_to_camera[0], drive.T_robot_camera[0].inverse() * drive.T_robot_camera[1]), 1.2);
}

// Straight frames that are no stops: a segment of the recording says what they are for.
TEST(SensorX2Car, ReadsStraightSegments) {
  const TempFolder folder;
  Steps turns(planar_pose(-1.5, -0.8, 0.1)), straight(planar_pose(-2.0, 0.3, -0.1));
  turns.arc(0.1, 10.0, 5);
  straight.forward(0.15, 5);
  const std::vector<Rigid3> cameras = {two_cameras()[1]};
  RoomDrive drive = drive_through_room(turns.poses, cameras, false, folder / "turns");
  const RoomDrive ahead = drive_through_room(straight.poses, cameras, false, folder / "ahead");
  drive.recording.folder = folder.path();
  drive.recording.segments.push_back({kStraightSegment, 99.5, 200.0});
  for (Exclusion& exclusion : drive.observations.exclusions) exclusion.file = "turns/" + exclusion.file;
  for (CameraFrame& frame : drive.recording.frames[0]) frame.color_file = "turns/" + frame.color_file;
  for (CameraFrame frame : ahead.recording.frames[0]) {
    frame.color_file = "ahead/" + frame.color_file;
    frame.stamp_s += 100.0;
    drive.recording.frames[0].push_back(frame);
  }
  const MethodInput input{drive.observations, &drive.recording, 2};
  const Result result = run_method(sensorx2car_method(), input);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  EXPECT_LT(angle_deg(result.camera_to_robot[0], cameras[0]), 0.8) << text(result.notes);
  drive.recording.segments.clear();
  EXPECT_THAT(sensorx2car_method().why_not(input), HasSubstr("0 straight steps"));
}

TEST(SensorX2Car, NeedsStraightStepsAndImages) {
  Steps steps(planar_pose(0.0, 0.0, 0.0));
  steps.arc(0.2, 10.0, 8);
  Observations observations;
  for (const Rigid3& pose : steps.poses)
    observations.stops.push_back({0.0, pose.translation.x(), pose.translation.y(), yaw_of(pose), 0.0});
  const Recording recording;
  EXPECT_THAT(sensorx2car_method().why_not({observations}), HasSubstr("observations alone"));
  EXPECT_THAT(sensorx2car_method().why_not({observations, &recording, 1}), HasSubstr("0 straight steps"));
  EXPECT_EQ(run_method(sensorx2car_method(), {observations, &recording, 1}).status, ResultStatus::kRefused);
}

TEST(RobotAutocalib, FindsPoseAndScaleFromFeatures) {
  const TempFolder folder;
  const RoomDrive drive = drive_through_room(straight_and_turns(), two_cameras(), false, folder.path());
  const Result result = run_method(robot_autocalib_method(), {drive.observations, &drive.recording, 2});
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector6d error = transform_error(result.camera_to_robot[k].T_parent_child, drive.T_robot_camera[k]);
    // Small images and short steps; the published means are 0.9 cm and 1.9 deg an axis.
    EXPECT_LT(error.head<3>().norm(), 0.08) << text(result.notes);
    EXPECT_LT(rad_to_deg(error.tail<3>().norm()), 2.5) << text(result.notes);
  }
}

TEST(RobotAutocalib, NeedsImages) {
  const Observations observations;
  EXPECT_THAT(robot_autocalib_method().why_not({observations}), HasSubstr("observations alone"));
}

/// Says no from some question on.
class Patience {
 public:
  void hold_for(int questions) {
    left_ = questions;
    asked = 0;
  }
  std::function<bool()> keep_going() {
    return [this] { return ++asked < left_; };
  }
  int asked = 0;

 private:
  int left_ = 0;
};

// A caller who wants no answer any more gets none, and is not asked again: after the first image, amid the work, and
// at its last piece.
void expect_abandoned(MethodInput input, const std::function<void(const MethodInput&)>& work) {
  Patience patience;
  input.keep_going = patience.keep_going();
  patience.hold_for(1 << 20);
  work(input);
  const int questions = patience.asked;
  ASSERT_GE(questions, 4);
  for (const int answered : {1, questions / 2, questions}) {
    patience.hold_for(answered);
    try {
      work(input);
      ADD_FAILURE() << "worked on after question " << answered << " of " << questions;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kTryAgain);
      EXPECT_EQ(patience.asked, answered);
    }
  }
}

TEST(ImageMethods, AreAbandonedAtEveryPieceOfTheirWork) {
  const TempFolder folder;
  Steps steps(planar_pose(-1.6, -0.7, 0.2));
  steps.forward(0.25, 3);
  steps.arc(0.3, 9.0, 1);
  const RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, true, folder.path());
  const MethodInput input{drive.observations, &drive.recording, 1};
  for (const Method* method : {&robot_autocalib_method(), &sensorx2car_method(), &memroc_reference_method()}) {
    SCOPED_TRACE(method->traits().name);
    expect_abandoned(input, [method](const MethodInput& asked) { run_method(*method, asked); });
  }
  SCOPED_TRACE("ground from images");
  expect_abandoned(input, [](const MethodInput& asked) {
    Observations observations = asked.observations;
    take_ground_from(GroundSource::kImages, asked, &observations);
  });
}

// What a network cannot do is no fault of an image, which would be left out.
TEST(ImageMethods, ANetworkThatFailsIsAnError) {
  class Broken : public FeatureSource {
   public:
    ImageFeatures detect(const Image8& /*grey*/) const override { throw Error("the network does not take it"); }
  };
  const TempFolder folder;
  Steps steps(planar_pose(-1.6, -0.7, 0.2));
  steps.forward(0.2, 1);
  const RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, false, folder.path());
  const Broken broken;
  MethodInput input{drive.observations, &drive.recording, 2};
  input.features = &broken;
  EXPECT_THROW(run_method(robot_autocalib_method(), input), Error);
}

}  // namespace
}  // namespace rigproof
