// What every shipped world promises: the paper's data set sees its board there, a robot drives there without touching
// anything, along the straight path as well, its ground is found in depth and never taken from a wall, although walls
// are there, and images have features to match.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "driven.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/generator/dataset.h"
#include "rigproof/generator/generate.h"
#include "rigproof/sim/physics.h"
#include "scenario.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

class Worlds : public testing::TestWithParam<std::string> {};

// The paper's data set without its drive, which keeps more of a margin around the board.
TEST_P(Worlds, ShowTheWholeBoardInThePapersDataSet) {
  const std::vector<GenerateConfig> runs = runs_of(load_generate_config(find_data_file("config", "paper/dataset")));
  ASSERT_EQ(runs.size(), scene_model_names().size());
  const auto run =
      std::find_if(runs.begin(), runs.end(), [](const GenerateConfig& config) { return config.scene == GetParam(); });
  ASSERT_NE(run, runs.end());
  GenerateConfig config = *run;
  config.motion = "teleport";
  config.straight_drive.frames = 0;
  const Scenario scenario = resolve_scenario(config);
  ASSERT_EQ(scenario.stop_count(), 100U);
  ASSERT_EQ(scenario.camera_count(), 3U);
  int whole = 0;
  for (const Viewpoint& stop : scenario.plan.stops) {
    EXPECT_GE(stop.cameras_with_board, 1);
    whole += stop.cameras_with_board;
  }
  EXPECT_GE(whole, 270) << "of 300 images";
}

// Bumpers' poses of the whole way, twenty a second, looked at anew.
std::size_t touches_on_the_way(const Scenario& scenario) {
  const DrivePhysics physics(scenario.world->description(), {});
  const std::vector<Rigid3>& poses = scenario.trajectory.poses();
  std::size_t touches = 0;
  for (std::size_t i = 0; i < poses.size(); i += 5) touches += physics.obstacle(poses[i], 0.0).empty() ? 0U : 1U;
  return touches;
}

void expect_planned_places(const Scenario& scenario) {
  ASSERT_EQ(scenario.plan.stops.size(), scenario.stop_count());
  EXPECT_EQ(scenario.viewpoints_replaced, 0U);
  for (std::size_t i = 0; i < scenario.stop_count(); ++i) {
    const Rigid3 planned = scenario.plan.stops[i].T_scene_robot(), &real = scenario.T_scene_robot[i];
    EXPECT_LT((planned.translation - real.translation).norm(), 0.02) << "stop " << i;
    EXPECT_LT(std::abs(wrap_angle(yaw_of(planned) - yaw_of(real))), deg_to_rad(1.0)) << "stop " << i;
  }
}

void expect_level_ground(const Scenario& scenario, const PlaneObservation& plane) {
  const Rigid3 T_scene_camera = scenario.T_scene_robot[static_cast<std::size_t>(plane.stop)] *
                                scenario.rig.T_robot_camera[static_cast<std::size_t>(plane.camera)];
  const Eigen::Vector3d up = -(T_scene_camera.rotation * plane.inverse_depth_plane.normalized());
  EXPECT_GT(up.z(), std::cos(deg_to_rad(1.0))) << "stop " << plane.stop << ", camera " << plane.camera;
  EXPECT_NEAR(height_above(plane).height_m, T_scene_camera.translation.z(), 0.005)
      << "stop " << plane.stop << ", camera " << plane.camera;
}

// Of the points of a depth image those that stand on the floor: walls, and what else might be taken for ground.
double standing_share(const Recording& recording, const Scenario& scenario, std::size_t stop, std::size_t camera) {
  const auto depth = read_depth_image(recording.folder / recording.frames[camera][stop].depth_file);
  const DepthPoints seen = points_from_depth(std::get<Image16>(depth), recording.rig.cameras[camera], 5);
  const Rigid3 T_scene_camera = scenario.T_scene_robot[stop] * scenario.rig.T_robot_camera[camera];
  const auto stands = [&](const Eigen::Vector3f& p) { return (T_scene_camera * p.cast<double>()).z() > 0.3; };
  return static_cast<double>(std::count_if(seen.points.begin(), seen.points.end(), stands)) /
         static_cast<double>(seen.points.size());
}

std::size_t keypoints_of(const Recording& recording, std::size_t stop, std::size_t camera) {
  const auto file = recording.folder / recording.frames[camera][stop].color_file;
  std::vector<cv::KeyPoint> found;
  cv::SIFT::create()->detect(cv::imread(file.string(), cv::IMREAD_GRAYSCALE), found);
  return found.size();
}

TEST_P(Worlds, AreDrivenInWithoutATouchAndTheirGroundIsFoundInDepth) {
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder / "run";
  options.jobs = 1;
  const GenerateConfig config = parse_generate_config("include: plain.yaml\nscene: " + GetParam() +
                                                          "\nmotion: drive\nrig: husky_3x_d455\nimage_scale: 0.4\n"
                                                          "poses: 4\nseed: 5\nstraight_drive: {frames: 3}\n"
                                                          "sensing: {told: exact}\n",
                                                      "world.yaml");
  const std::shared_ptr<const Scenario> scenario = prepare_generation(config, options);
  ASSERT_EQ(scenario->stop_count(), 7U);
  EXPECT_EQ(touches_on_the_way(*scenario), 0U);
  expect_planned_places(*scenario);
  ASSERT_TRUE(generate(*scenario, options).complete);
  const Recording recording = load_recording(folder / "run/recording");
  const Observations observations = observe(recording);
  // Four viewpoints and three cameras; frames of the straight drive are none of calibration's.
  EXPECT_EQ(observations.ground_planes.size(), 12U);
  for (const PlaneObservation& plane : observations.ground_planes) expect_level_ground(*scenario, plane);
  double standing = 0.0;
  for (std::size_t stop = 0; stop < 4; ++stop) {
    standing = std::max(standing, standing_share(recording, *scenario, stop, 1));
    EXPECT_GT(keypoints_of(recording, stop, 1), 100U) << "stop " << stop;
  }
  EXPECT_GT(standing, 0.05) << "nothing tempts a search for planes";
}

INSTANTIATE_TEST_SUITE_P(Shipped, Worlds, testing::ValuesIn(scene_model_names()),
                         [](const auto& world) { return world.param; });

}  // namespace
}  // namespace rigproof
