#include "rigproof/calib/geometry/initial_guess.h"

#include <gtest/gtest.h>

#include "pose_near.h"
#include "rigproof/core/random.h"
#include "synthetic_drive.h"
#include "trials.h"

namespace rigproof {
namespace {

InitialGuess guess_of(const SyntheticDrive& drive) {
  const TrajectoryAlignment alignment = align_trajectories(drive.observations, drive.views);
  return initial_guess(drive.observations, drive.views, alignment, check_ground_planes(drive.observations, alignment));
}

void expect_near_truth(const SyntheticDrive& drive, const InitialGuess& guess, double distance_m, double angle_rad) {
  for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k) {
    ASSERT_TRUE(guess.T_robot_camera[k]) << "camera " << k;
    EXPECT_TRUE(IsPoseNear(drive.T_robot_camera[k], *guess.T_robot_camera[k], distance_m, angle_rad)) << "camera " << k;
  }
  ASSERT_TRUE(guess.T_world_board);
  EXPECT_TRUE(IsPoseNear(drive.T_world_board, *guess.T_world_board, distance_m, angle_rad));
  for (std::size_t i = 0; i < drive.T_world_robot.size(); ++i)
    EXPECT_TRUE(IsPoseNear(drive.T_world_robot[i], guess.T_world_robot[i], 2.0 * distance_m, 2.0 * angle_rad));
}

TEST(InitialGuess, FindsAnyMountingFromExactDataOverTrials) {
  const auto seeds = static_cast<std::uint64_t>(Trials(40, 200).count());
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(seed);
    DriveOptions options = any_mounting(seed, 8);
    options.stops = 24;
    const SyntheticDrive drive = make_drive(options);
    // Not exact: the weak prior on translations (3 m against millimetres) and the planes' noise remain.
    expect_near_truth(drive, guess_of(drive), 2e-3, 1e-4);
    if (HasFailure()) return;
  }
}

TEST(InitialGuess, FindsAnyMountingFromNoisyDataOverTrials) {
  const auto seeds = static_cast<std::uint64_t>(Trials(40, 200).count());
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(seed);
    DriveOptions options = any_mounting(seed, 4);
    options.stops = 24;
    options.corner_sigma_px = 0.1;
    options.odometry_sigma_m = 0.002;
    options.odometry_sigma_rad = 0.01;
    const SyntheticDrive drive = make_drive(options);
    const InitialGuess guess = guess_of(drive);
    // A start has to lie within 15 degrees, and well within a step, of the answer; non-overlapping cameras are tied
    // together by a few drifting odometry increments only.
    for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k) {
      ASSERT_TRUE(guess.T_robot_camera[k]);
      EXPECT_TRUE(IsPoseNear(drive.T_robot_camera[k], *guess.T_robot_camera[k], 0.15, deg_to_rad(6.0)));
    }
  }
}

// What was taken for a small board elsewhere: a view that is seen turned by degrees, at stops of its own.
void put_a_false_board(int camera, RandomStream& random, SyntheticDrive* drive) {
  std::vector<ViewPose*> own;
  for (ViewPose& view : drive->views)
    if (view.camera == camera) own.push_back(&view);
  if (own.size() < 6) return;
  ViewPose& view = *own[random.below(static_cast<std::uint32_t>(own.size()))];
  const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
  view.T_camera_board.rotation = Eigen::Quaterniond(so3_exp(random.uniform(1.0, 3.0) * turn.normalized()));
  view.T_camera_board.translation *= 3.0;
  view.covariance.topLeftCorner<3, 3>() = 1e-2 * Eigen::Matrix3d::Identity();
  view.covariance.bottomRightCorner<3, 3>() = 1e-2 * Eigen::Matrix3d::Identity();
}

// A camera that looks back sees the board now and then: a false one among its views turned it by 164 degrees.
TEST(InitialGuess, AFalseBoardOfEveryCameraTakesNoneAlongOverTrials) {
  const auto seeds = static_cast<std::uint64_t>(Trials(300, 1000).count());
  int astray = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    DriveOptions options = any_mounting(seed, 5);
    options.stops = 24;
    options.corner_sigma_px = 0.1;
    options.odometry_sigma_m = 0.002;
    options.odometry_sigma_rad = 0.01;
    SyntheticDrive drive = make_drive(options);
    RandomStream random(seed, "false board");
    for (int camera = 0; camera < static_cast<int>(drive.T_robot_camera.size()); ++camera)
      put_a_false_board(camera, random, &drive);
    const InitialGuess guess = guess_of(drive);
    for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k)
      astray += !guess.T_robot_camera[k] ||
                !IsPoseNear(drive.T_robot_camera[k], *guess.T_robot_camera[k], 0.3, deg_to_rad(15.0));
  }
  EXPECT_EQ(astray, 0);
}

// Of very many planes not each is tried as the common height; a table in every third image is no floor for all that.
TEST(GroundCheck, FindsTheFloorAmongVeryManyPlanes) {
  constexpr int kPlanes = 30001;
  Observations observations;
  observations.cameras.resize(1);
  TrajectoryAlignment alignment;
  alignment.up_camera = {Eigen::Vector3d(0.0, -1.0, 0.0)};
  for (int i = 0; i < kPlanes; ++i) {
    PlaneObservation plane;
    plane.stop = i;
    plane.inverse_depth_plane = Eigen::Vector3d(0.0, 1.0 / (i % 3 == 1 ? 0.4 : 0.7), 0.0);
    plane.covariance_per_m2 = 1e-8 * Eigen::Matrix3d::Identity();
    observations.ground_planes.push_back(plane);
  }
  const GroundCheck check = check_ground_planes(observations, alignment);
  EXPECT_EQ(check.count(observations, 0), kPlanes - kPlanes / 3);
  for (const Exclusion& exclusion : check.rejected) EXPECT_EQ(exclusion.stop % 3, 1);
}

}  // namespace
}  // namespace rigproof
