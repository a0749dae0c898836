// The ground from images of a patterned room.
#include "rigproof/calib/vision/image_ground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "error_text.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "room.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

std::vector<Rigid3> before_the_board() {
  Steps steps(planar_pose(-1.6, -0.7, 0.2));
  steps.arc(0.4, 5.0, 3);
  steps.arc(-0.35, 4.0, 3);
  steps.arc(0.4, -8.0, 3);
  return steps.poses;
}

TEST(ImageGround, FindsTheFloorWithoutDepth) {
  const TempFolder folder;
  const std::vector<Rigid3> cameras = {two_cameras()[0]};
  const RoomDrive drive = drive_through_room(before_the_board(), cameras, true, folder.path());
  ASSERT_GE(drive.observations.board_views.size(), 8U);
  const ImageGround ground = ground_from_images({drive.observations, &drive.recording, 2}, *sift_features());
  ASSERT_GE(ground.planes.size(), 4U);
  const Eigen::Vector3d up = cameras[0].rotation.conjugate() * Eigen::Vector3d::UnitZ();
  for (const PlaneObservation& plane : ground.planes) {
    const Eigen::Vector3d normal = -plane.inverse_depth_plane.normalized();
    // Steps of 40 cm forwards at a focal length of 300 px: one plane is good to a centimetre and half a degree.
    EXPECT_NEAR(height_above(plane).height_m, cameras[0].translation.z(), 0.03);
    EXPECT_LT(rad_to_deg(std::acos(std::min(1.0, normal.dot(up)))), 1.5);
    EXPECT_GT(height_above(plane).sigma_m, 0.0);
  }
}

// Stops planned for the board lie far apart from one to the next; what was taken from nearby may be any other image.
TEST(ImageGround, ComparesImagesFromNearbyWheneverTheyWereTaken) {
  const TempFolder folder;
  const std::vector<Rigid3> cameras = {two_cameras()[0]};
  std::vector<Rigid3> here = before_the_board(), poses;
  for (const Rigid3& pose : here) {
    poses.push_back(pose);
    poses.push_back(planar_pose(0.3, 1.5, -0.7) * pose);
  }
  const RoomDrive drive = drive_through_room(poses, cameras, true, folder.path());
  const ImageGround ground = ground_from_images({drive.observations, &drive.recording, 2}, *sift_features());
  ASSERT_GE(drive.observations.board_views.size(), 14U);
  EXPECT_GE(ground.planes.size(), 10U);
  std::set<int> stops;
  for (const PlaneObservation& plane : ground.planes) {
    EXPECT_NEAR(height_above(plane).height_m, cameras[0].translation.z(), 0.03);
    EXPECT_TRUE(stops.insert(plane.stop).second) << plane.stop;
  }
}

// Far points, whose depth is hardly known, would take the feet of the walls into the floor, and a shift of all features
// would tilt it: heights 6 mm too large.
TEST(ImageGround, HeightsHaveNoErrorInCommon) {
  const Rigid3 camera = mounted(0.2, 0.1, 0.6, -0.1, 0.35, 0.03);
  double sum = 0.0;
  int count = 0;
  for (int drive_number = 0; drive_number < 3; ++drive_number) {
    const TempFolder folder;
    Steps steps(planar_pose(-2.2 + 0.4 * drive_number, -0.9 + 0.6 * drive_number, 0.15 - 0.15 * drive_number));
    steps.arc(0.35, 5.0, 3);
    steps.arc(-0.35, 4.0, 2);
    steps.arc(0.35, -6.0, 3);
    const RoomDrive drive = drive_through_room(steps.poses, {camera}, true, folder.path());
    const ImageGround ground = ground_from_images({drive.observations, &drive.recording, 2}, *sift_features());
    for (const PlaneObservation& plane : ground.planes) sum += height_above(plane).height_m - camera.translation.z();
    count += static_cast<int>(ground.planes.size());
  }
  ASSERT_GE(count, 20);
  // One plane scatters by 2 mm.
  EXPECT_NEAR(sum / count, 0.0, 0.001);
}

TEST(ImageGround, LeavesCamerasWithDepthAlone) {
  const TempFolder folder;
  RoomDrive drive =
      drive_through_room({before_the_board()[0], before_the_board()[1]}, {two_cameras()[0]}, true, folder.path());
  drive.observations.ground_planes.emplace_back();
  EXPECT_TRUE(ground_from_images({drive.observations, &drive.recording, 1}, *sift_features()).planes.empty());
  EXPECT_TRUE(ground_from_images({drive.observations}, *sift_features()).planes.empty());
}

TEST(GroundSource, GivesACameraWithoutDepthItsHeight) {
  const TempFolder folder;
  const std::vector<Rigid3> cameras = {two_cameras()[0]};
  RoomDrive drive = drive_through_room(before_the_board(), cameras, true, folder.path());
  const MethodInput input{drive.observations, &drive.recording, 2};
  Observations depth = drive.observations;
  EXPECT_TRUE(take_ground_from(GroundSource::kDepth, input, &depth).findings.empty());
  EXPECT_TRUE(depth.ground_planes.empty());
  EXPECT_FALSE(find_method("memroc").solve(depth).camera_to_robot.at(0).observable[2]);
  Observations images = drive.observations;
  const GroundReport report = take_ground_from(GroundSource::kAuto, input, &images);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].code, "ground.from_images");
  const Result result = find_method("memroc").solve(images);
  ASSERT_EQ(result.status, ResultStatus::kSolved) << testing::PrintToString(result.reasons);
  EXPECT_NEAR(result.camera_to_robot[0].T_parent_child.translation.z(), cameras[0].translation.z(), 0.02);
}

// A depth stream that hardly ever shows the ground is replaced; one that does is left alone, unless images are asked
// for.
TEST(GroundSource, TrustsDepthThatShowsTheGroundOftenEnough) {
  const TempFolder folder;
  const std::vector<Rigid3> cameras = {two_cameras()[0]};
  RoomDrive drive = drive_through_room(before_the_board(), cameras, true, folder.path());
  drive.observations.cameras[0].depth = DepthStream();
  const Eigen::Vector3d up = cameras[0].rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const auto with_planes = [&](std::size_t count) {
    Observations observations = drive.observations;
    for (std::size_t i = 0; i < count; ++i) {
      const BoardView& view = observations.board_views[i];
      PlaneObservation plane;
      plane.stop = view.stop;
      plane.camera = view.camera;
      plane.file = view.file;
      plane.inverse_depth_plane = -up / cameras[0].translation.z();
      plane.covariance_per_m2 = 1e-4 * Eigen::Matrix3d::Identity();
      observations.ground_planes.push_back(plane);
    }
    return observations;
  };
  const MethodInput input{drive.observations, &drive.recording, 2};
  EXPECT_EQ(cameras_without_trusted_depth(with_planes(2)), std::vector<int>{0});
  EXPECT_TRUE(cameras_without_trusted_depth(with_planes(6)).empty());
  Observations enough = with_planes(6);
  EXPECT_TRUE(take_ground_from(GroundSource::kAuto, input, &enough).findings.empty());
  EXPECT_TRUE(enough.cameras[0].depth.has_value());
  const GroundReport report = take_ground_from(GroundSource::kImages, input, &enough);
  ASSERT_EQ(report.findings.size(), 1U);
  ASSERT_NE(report.findings[0].find("instead_of"), nullptr);
  EXPECT_EQ(*report.findings[0].find("instead_of"), FindingValue("instead_of", 6));
  EXPECT_DOUBLE_EQ(enough.cameras[0].depth.value().noise.scale_sigma, 0.001);
  EXPECT_GE(enough.ground_planes.size(), 4U);
}

TEST(GroundSource, GoesByName) {
  EXPECT_EQ(ground_source_by_name("auto"), GroundSource::kAuto);
  EXPECT_THAT(error_text([] { ground_source_by_name("image"); }), testing::HasSubstr("did you mean \"images\""));
}

}  // namespace
}  // namespace rigproof
