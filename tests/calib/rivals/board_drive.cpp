#include "board_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "worded.h"

namespace rigproof {
namespace {

void add(const Rigid3& estimate, const Rigid3& truth, WorstError* worst) {
  const Vector6d error = transform_error(estimate, truth);
  worst->distance_m = std::max(worst->distance_m, error.head<3>().norm());
  worst->height_m = std::max(worst->height_m, std::abs(error(2)));
  worst->angle_rad = std::max(worst->angle_rad, error.tail<3>().norm());
}

SyntheticDrive with_depth(SyntheticDrive drive) {
  for (RigCamera& camera : drive.observations.cameras) camera.depth.emplace();
  return drive;
}

}  // namespace

SyntheticDrive exact_drive(std::uint64_t seed, int stops) {
  DriveOptions options;
  options.seed = seed;
  options.stops = stops;
  options.plane_sigma_per_m = 0.0;
  return with_depth(make_drive(options));
}

SyntheticDrive fine_drive(std::uint64_t seed, int stops) {
  DriveOptions options;
  options.seed = seed;
  options.stops = stops;
  options.corner_sigma_px = 0.02;
  options.odometry_sigma_m = options.odometry_sigma_rad = 2e-4;
  return with_depth(make_drive(options));
}

void turn_board(double angle_rad, SyntheticDrive* drive) {
  const Board& board = drive->observations.board;
  const Rigid3 T_board_centre(Eigen::Quaterniond::Identity(), board.centre());
  const Rigid3 turn(rotation_z(angle_rad), Eigen::Vector3d::Zero());
  drive->T_world_board = drive->T_world_board * T_board_centre * turn * T_board_centre.inverse();
  for (BoardView& view : drive->observations.board_views) {
    const Rigid3& X = drive->T_robot_camera[static_cast<std::size_t>(view.camera)];
    const Rigid3& pose = drive->T_world_robot[static_cast<std::size_t>(view.stop)];
    const Rigid3 T_camera_board = (pose * X).inverse() * drive->T_world_board;
    const Camera& camera = drive->observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    for (CornerObservation& corner : view.corners)
      ASSERT_TRUE(camera.project(T_camera_board * board.corner(corner.id), &corner.pixel));
  }
}

WorstError worst_error(const Result& result, const SyntheticDrive& drive) {
  WorstError worst;
  EXPECT_EQ(result.camera_to_robot.size(), drive.T_robot_camera.size()) << result.method;
  for (std::size_t k = 0; k < drive.T_robot_camera.size(); ++k) {
    const EstimatedTransform* found = result.find(drive.observations.robot_frame, drive.observations.cameras[k].name);
    if (found == nullptr || !found->fully_observable())
      ADD_FAILURE() << result.method << " gives no whole pose of camera " << k << ": "
                    << result_status_name(result.status) << testing::PrintToString(result.reasons)
                    << testing::PrintToString(result.notes);
    else
      add(found->T_parent_child, drive.T_robot_camera[k], &worst);
  }
  return worst;
}

WorstError worst_pair_error(const Result& result, const SyntheticDrive& drive) {
  WorstError worst;
  for (std::size_t j = 0; j < drive.T_robot_camera.size(); ++j) {
    for (std::size_t k = j + 1; k < drive.T_robot_camera.size(); ++k) {
      const EstimatedTransform* found =
          result.find(drive.observations.cameras[j].name, drive.observations.cameras[k].name);
      if (found == nullptr)
        ADD_FAILURE() << result.method << " gives no pose of camera " << k << " in camera " << j;
      else
        add(found->T_parent_child, drive.T_robot_camera[j].inverse() * drive.T_robot_camera[k], &worst);
    }
  }
  return worst;
}

}  // namespace rigproof
