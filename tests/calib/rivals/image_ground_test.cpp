// The ground from images of a patterned room.
#include "rigproof/calib/image_ground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rigproof/calib/trajectory_alignment.h"
#include "rigproof/core/conventions.h"
#include "room.h"
#include "temp_folder.h"

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

TEST(ImageGround, LeavesCamerasWithDepthAlone) {
  const TempFolder folder;
  RoomDrive drive =
      drive_through_room({before_the_board()[0], before_the_board()[1]}, {two_cameras()[0]}, true, folder.path());
  drive.observations.ground_planes.emplace_back();
  EXPECT_TRUE(ground_from_images({drive.observations, &drive.recording, 1}, *sift_features()).planes.empty());
  EXPECT_TRUE(ground_from_images({drive.observations}, *sift_features()).planes.empty());
}

}  // namespace
}  // namespace rigproof
