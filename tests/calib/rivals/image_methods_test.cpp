// Methods that see features: on images of a patterned room whose truth is exact.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

#include "map_memory.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "room.h"
#include "temp_folder.h"
#include "turn_axes.h"
#include "vertical_lines.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

std::string text(const std::vector<Finding>& findings) { return testing::PrintToString(worded(findings)); }

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

void expect_pose_and_scale(const Result& result, const RoomDrive& drive) {
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector6d error = transform_error(result.camera_to_robot[k].T_parent_child, drive.T_robot_camera[k]);
    // Small images and short steps; the published means are 0.9 cm and 1.9 deg an axis.
    EXPECT_LT(error.head<3>().norm(), 0.08) << text(result.notes);
    EXPECT_LT(rad_to_deg(error.tail<3>().norm()), 2.5) << text(result.notes);
  }
}

void expect_rotation(const Result& result, const RoomDrive& drive) {
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

// One drive and one search for matches for both methods: it takes most of the time.
TEST(ImageMethods, FindForwardAndSideCamerasFromFeatures) {
  const TempFolder folder;
  const RoomDrive drive = drive_through_room(straight_and_turns(), two_cameras(), false, folder.path());
  MapMemory memory;
  MethodInput input{drive.observations, &drive.recording, 2};
  input.memory = &memory;
  EXPECT_FALSE(find_method("sensorx2car").why_not(input));
  expect_pose_and_scale(run_method(find_method("robot_autocalib"), input), drive);
  expect_rotation(run_method(find_method("sensorx2car"), input), drive);
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
  const Result result = run_method(find_method("sensorx2car"), input);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  EXPECT_LT(angle_deg(result.camera_to_robot[0], cameras[0]), 0.8) << text(result.notes);
  drive.recording.segments.clear();
  EXPECT_THAT(worded(find_method("sensorx2car").why_not(input)), HasSubstr("0 straight steps"));
}

// Where the robot never turns, plumb edges of the walls show the vertical.
TEST(SensorX2Car, FindsTheVerticalInPlumbLines) {
  const TempFolder folder;
  Steps steps(planar_pose(-2.0, -0.8, 0.1));
  steps.forward(0.2, 5);
  const RoomDrive drive = drive_through_room(steps.poses, two_cameras(), false, folder.path(), Walls::kPanelled);
  const Result result = run_method(find_method("sensorx2car"), {drive.observations, &drive.recording, 2});
  ASSERT_EQ(result.status, ResultStatus::kSolved) << text(result.reasons) << text(result.notes);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_LT(angle_deg(result.camera_to_robot[k], drive.T_robot_camera[k]), 0.8) << text(result.notes);
  EXPECT_THAT(text(result.notes), HasSubstr("plumb lines in 6 images"));
}

// A pattern without edges has none.
TEST(SensorX2Car, SaysThatNothingShowsTheVertical) {
  const TempFolder folder;
  Steps steps(planar_pose(-2.0, -0.8, 0.1));
  steps.forward(0.2, 4);
  const RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, false, folder.path());
  const Result result = run_method(find_method("sensorx2car"), {drive.observations, &drive.recording, 2});
  EXPECT_EQ(result.status, ResultStatus::kRefused) << text(result.notes);
  EXPECT_THAT(text(result.reasons), HasSubstr("plumb lines"));
}

/// Lines of a direction, of random places, in `images` images.
void add_lines(const Eigen::Vector3d& direction, int count, double noise, RandomStream* random,
               std::vector<std::vector<rivals::SeenLine>>* images) {
  for (auto& lines : *images) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d ray(random->uniform(-0.6, 0.6), random->uniform(-0.4, 0.4), 1.0);
      const Eigen::Vector3d off(random->normal(), random->normal(), random->normal());
      lines.push_back({(ray.cross(direction).normalized() + noise * off).normalized(), 60.0});
    }
  }
}

TEST(PlumbLines, AreTheUprightDirectionSquareToTheWayAhead) {
  const Rigid3 X = mounted(0.0, 0.0, 0.7, deg_to_rad(35.0), deg_to_rad(25.0), deg_to_rad(-20.0));
  const Eigen::Matrix3d R = X.rotation_matrix().transpose();
  RandomStream random(1, "lines");
  std::vector<std::vector<rivals::SeenLine>> images(8);
  for (int i = 0; i < 25; ++i)
    add_lines(Eigen::Vector3d(random.normal(), random.normal(), random.normal()), 1, 0.0, &random, &images);
  add_lines(R * Eigen::Vector3d::UnitX(), 12, 0.003, &random, &images);
  add_lines(R * Eigen::Vector3d::UnitY(), 12, 0.003, &random, &images);
  EXPECT_FALSE(rivals::plumb_direction(images, R.col(0), 0));
  add_lines(R * Eigen::Vector3d::UnitZ(), 8, 0.003, &random, &images);
  const auto plumb = rivals::plumb_direction(images, R.col(0), 0);
  ASSERT_TRUE(plumb);
  EXPECT_EQ(plumb->images, 8U);
  EXPECT_LT(rad_to_deg(std::acos(std::min(1.0, plumb->up.dot(R.col(2))))), 0.1);
  // Two images could be chance.
  images.resize(2);
  EXPECT_FALSE(rivals::plumb_direction(images, R.col(0), 0));
}

// Camera and robot turn by the same angle. A wrong pose between two images turns by any, and would weigh most.
TEST(TurnAxes, LeaveOutWhatTurnsOtherwiseThanTheRobot) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.9, -0.3).normalized();
  const auto pose = [](double angle_deg, const Eigen::Vector3d& axis) {
    return rivals::RelativePose{Rigid3(so3_exp(deg_to_rad(angle_deg) * axis), Eigen::Vector3d::UnitZ()), {}};
  };
  const rivals::Step left{0.3, 0.0, deg_to_rad(10.0)}, right{0.3, 0.0, deg_to_rad(-10.0)};
  for (const auto& axis : {rivals::turn_axis(left, pose(9.5, up)), rivals::turn_axis(right, pose(-9.5, up))}) {
    ASSERT_TRUE(axis);
    EXPECT_LT((axis->up - up).norm(), 1e-9);
    EXPECT_NEAR(axis->weight, deg_to_rad(9.5) * deg_to_rad(9.5), 1e-12);
  }
  EXPECT_FALSE(rivals::turn_axis(left, pose(170.0, Eigen::Vector3d::UnitZ())));
  EXPECT_FALSE(rivals::turn_axis(left, pose(1.5, up)));
  EXPECT_FALSE(rivals::turn_axis({0.3, 0.0, deg_to_rad(1.0)}, pose(1.0, up)));
}

TEST(SensorX2Car, NeedsStraightStepsAndImages) {
  Steps steps(planar_pose(0.0, 0.0, 0.0));
  steps.arc(0.2, 10.0, 8);
  Observations observations;
  for (const Rigid3& pose : steps.poses)
    observations.stops.push_back({0.0, pose.translation.x(), pose.translation.y(), yaw_of(pose), 0.0});
  const Recording recording;
  EXPECT_THAT(worded(find_method("sensorx2car").why_not({observations})), HasSubstr("observations only"));
  EXPECT_THAT(worded(find_method("sensorx2car").why_not({observations, &recording, 1})), HasSubstr("0 straight steps"));
  EXPECT_EQ(run_method(find_method("sensorx2car"), {observations, &recording, 1}).status, ResultStatus::kRefused);
}

TEST(RobotAutocalib, NeedsImages) {
  const Observations observations;
  EXPECT_THAT(worded(find_method("robot_autocalib").why_not({observations})), HasSubstr("observations only"));
}

/// Fails the test where an image is looked at.
class Unasked : public FeatureSource {
 public:
  ImageFeatures detect(const Image8& /*grey*/) const override {
    ADD_FAILURE() << "an image was looked at";
    return {};
  }
};

// Told before an image is opened: a straight drive shows no vertical.
TEST(RobotAutocalib, NeedsThreeTurns) {
  const TempFolder folder;
  Steps steps(planar_pose(-1.6, -0.7, 0.2));
  steps.forward(0.2, 2);
  steps.arc(0.2, 9.0, 2);
  RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, false, folder.path());
  const Unasked unasked;
  MethodInput input{drive.observations, &drive.recording, 2};
  input.features = &unasked;
  const Result result = run_method(find_method("robot_autocalib"), input);
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_THAT(text(result.reasons), HasSubstr("2 turns of 2 deg or more; at least three are needed"));
  // Turns are counted between images that the camera has: without the third one the two turns remain.
  drive.observations.stops[1].yaw_rad += deg_to_rad(3.0);
  EXPECT_FALSE(find_method("robot_autocalib").why_not(input));
  drive.recording.frames[0].erase(drive.recording.frames[0].begin() + 1);
  EXPECT_THAT(worded(find_method("robot_autocalib").why_not(input)), HasSubstr("has 2 turns"));
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
  steps.arc(0.3, 9.0, 3);
  RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, true, folder.path());
  for (CameraFrame& frame : drive.recording.frames[0]) frame.cloud_file = "cloud.txt";
  std::ofstream(folder / "cloud.txt") << "0 0 1\n1 0 1\n0 1 1\n";
  // As many as motions need: the work is done ten times, and matching grows with their square.
  const auto features = sift_features(600);
  MethodInput input{drive.observations, &drive.recording, 1};
  input.features = features.get();
  for (const Method* method :
       {&find_method("robot_autocalib"), &find_method("sensorx2car"), &find_method("memroc_reference")}) {
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
  steps.arc(0.2, 9.0, 3);
  const RoomDrive drive = drive_through_room(steps.poses, {two_cameras()[0]}, false, folder.path());
  const Broken broken;
  MethodInput input{drive.observations, &drive.recording, 2};
  input.features = &broken;
  EXPECT_THROW(run_method(find_method("robot_autocalib"), input), Error);
}

}  // namespace
}  // namespace rigproof
