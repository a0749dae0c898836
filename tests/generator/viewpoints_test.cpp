// Plans in a made-up world; what every stop promises is checked by projecting anew.
#include "rigproof/generator/viewpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "error_text.h"
#include "pillar_world.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

ViewpointConfig sampled() {
  ViewpointConfig config;
  config.planner = "sampled";
  return config;
}

// Cameras that see the whole board with its border, `margin_px` inside of the image, from the front.
int count_cameras(const ViewpointSubject& subject, const Viewpoint& stop, double margin_px, double max_obliquity_deg,
                  PillarWorld& world) {
  int count = 0;
  const Board& board = subject.board;
  for (const WorldCamera& camera : subject.cameras) {
    const Rigid3 T_scene_camera = stop.T_scene_robot() * camera.T_robot_camera;
    const Rigid3 T_board_camera = subject.T_scene_board.inverse() * T_scene_camera;
    const Rigid3 T_camera_board = T_board_camera.inverse();
    const double border = board.square_m + subject.board_margin_m;  // from the outer corners of the inner grid
    bool whole = true;
    for (const double x : {-border, board.square_m * (board.inner_corners_x() - 1) + border}) {
      for (const double y : {-border, board.square_m * (board.inner_corners_y() - 1) + border}) {
        Eigen::Vector2d pixel;
        const bool ahead = camera.camera.project(T_camera_board * Eigen::Vector3d(x, y, 0.0), &pixel);
        whole = whole && ahead && pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() <= 1279.0 - margin_px &&
                pixel.y() <= 719.0 - margin_px;
      }
    }
    const Eigen::Vector3d to_camera = T_board_camera.translation - board.centre();
    const double angle_deg = rad_to_deg(std::acos(-to_camera.z() / to_camera.norm()));
    const bool seen = world.in_sight(T_scene_camera.translation, subject.T_scene_board * board.centre(), 0);
    if (whole && angle_deg <= max_obliquity_deg && seen) ++count;
  }
  return count;
}

ViewpointPlan plan(const ViewpointConfig& config, std::int64_t poses, std::uint64_t seed) {
  PillarWorld world;
  return plan_viewpoints(config, poses, subject(), world, seed);
}

TEST(Viewpoints, EveryStopKeepsEveryConstraint) {
  PillarWorld world;
  ViewpointConfig config = sampled();
  config.min_cameras = 2;
  config.margin_px = 20.0;
  const ViewpointPlan result = plan_viewpoints(config, 200, subject(), world, 1);
  ASSERT_EQ(result.stops.size(), 200U);
  int all = 0;
  for (const Viewpoint& stop : result.stops) {
    EXPECT_EQ(world.obstacle(stop.T_scene_robot()), "");
    EXPECT_GE(stop.distance_m, 1.2);
    EXPECT_LE(stop.distance_m, 3.6);
    EXPECT_NEAR(std::hypot(stop.x_m, stop.y_m), stop.distance_m, 1e-12);
    EXPECT_NEAR(std::atan2(stop.y_m, stop.x_m), stop.bearing_rad, 1e-12);
    EXPECT_LE(std::abs(rad_to_deg(stop.bearing_rad)), 55.0);
    const int cameras = count_cameras(subject(), stop, 20.0, 60.0, world);
    EXPECT_GE(cameras, 2);
    EXPECT_EQ(cameras, stop.cameras_with_board);
    if (cameras == 3) ++all;
  }
  // 0.9 of 200 stops are drawn for all three cameras: 180 +- 4; the others may have them by chance.
  EXPECT_GE(all, 164);
  EXPECT_LT(all, 200);
}

TEST(Viewpoints, PlanIsRichInMotion) {
  const ViewpointPlan result = plan(sampled(), 100, 0);
  double turn = 0.0, length = 0.0;
  for (std::size_t i = 1; i < result.stops.size(); ++i) {
    turn += std::abs(wrap_angle(result.stops[i].yaw_rad - result.stops[i - 1].yaw_rad));
    length += std::hypot(result.stops[i].x_m - result.stops[i - 1].x_m, result.stops[i].y_m - result.stops[i - 1].y_m);
  }
  EXPECT_NEAR(length / 99.0, 1.6, 0.3);  // step_m
  EXPECT_GT(rad_to_deg(turn / 99.0), 15.0);
}

bool same(const std::vector<Viewpoint>& a, const std::vector<Viewpoint>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].x_m != b[i].x_m || a[i].y_m != b[i].y_m || a[i].yaw_rad != b[i].yaw_rad) return false;
  }
  return a.size() == b.size();
}

TEST(Viewpoints, SeedDecidesThePlan) {
  const ViewpointConfig config = sampled();
  EXPECT_TRUE(same(plan(config, 30, 7).stops, plan(config, 30, 7).stops));
  EXPECT_FALSE(same(plan(config, 30, 7).stops, plan(config, 30, 8).stops));
}

TEST(Viewpoints, DriveOrderKeepsTheSetOfPlaces) {
  ViewpointConfig config = sampled();
  std::vector<Viewpoint> drive = plan(config, 50, 0).stops;
  config.order = "drawn";
  std::vector<Viewpoint> drawn = plan(config, 50, 0).stops;
  const auto by_x = [](const Viewpoint& a, const Viewpoint& b) { return a.x_m < b.x_m; };
  std::sort(drive.begin(), drive.end(), by_x);
  std::sort(drawn.begin(), drawn.end(), by_x);
  EXPECT_TRUE(same(drive, drawn));
}

std::string error_of(const ViewpointConfig& config, const FloorArea& area = {-5.0, 5.0, -5.0, 5.0}) {
  PillarWorld world;
  world.area = area;
  return error_text([&] { plan_viewpoints(config, 20, subject(), world, 0); });
}

TEST(Viewpoints, ImpossibleWishesSayWhichConstraintForbidsThem) {
  EXPECT_THAT(error_of(sampled(), {3.0, 5.0, 3.0, 5.0}), HasSubstr("drivable area"));
  ViewpointConfig config = sampled();
  config.heading_deg = 120.0;
  EXPECT_THAT(error_of(config), HasSubstr("whole board"));
  config = sampled();
  config.bearing_deg = 75.0;
  EXPECT_THAT(error_of(config), HasSubstr("too flat an angle"));
  config = sampled();
  config.distance_m = 1.5;
  config.bearing_deg = 90.0;
  config.max_obliquity_deg = 85.0;
  EXPECT_NE(error_of(config), "");
  config = sampled();
  config.min_cameras = 4;
  EXPECT_THAT(error_of(config), HasSubstr("only 3 cameras"));
}

TEST(Viewpoints, GridGivesEveryPossibleCombination) {
  ViewpointConfig config;
  config.planner = "grid";
  config.order = "drawn";
  config.grid.distances_m = {2.2, 2.8};
  config.grid.bearings_deg = {-30.0, 0.0, 30.0, 90.0};  // the last one sees the board edge on
  config.grid.headings_deg = {0.0};
  const ViewpointPlan result = plan(config, 100, 0);
  EXPECT_EQ(result.stops.size(), 6U);
  EXPECT_EQ(result.skipped, 2U);
  EXPECT_NEAR(result.stops[0].distance_m, 2.2, 1e-12);
  EXPECT_NEAR(rad_to_deg(result.stops[0].bearing_rad), -30.0, 1e-9);
  EXPECT_NEAR(rad_to_deg(result.stops[0].yaw_rad), 150.0, 1e-9);  // from the board's bearing -30 back to it
  EXPECT_THAT(result.coverage, HasSubstr("2 places of the grid left out"));
}

TEST(Viewpoints, ListIsTakenAsItIsUnlessTheRobotCannotStandThere) {
  ViewpointConfig config;
  config.planner = "list";
  config.list = {{2.0, 0.0, 180.0}, {3.0, 0.0, 0.0}};
  const ViewpointPlan result = plan(config, 100, 0);
  ASSERT_EQ(result.stops.size(), 2U);
  EXPECT_EQ(result.stops[0].x_m, 2.0);
  EXPECT_EQ(result.stops[0].cameras_with_board, 3);
  EXPECT_EQ(result.stops[1].cameras_with_board, 0);  // looks away: allowed, and said
  EXPECT_THAT(result.coverage, HasSubstr("0 cameras at 1 stop"));
  config.list = {{2.0, 0.0, 180.0}, {0.0, 1.4, 0.0}, {9.0, 0.0, 0.0}};
  const std::string error = error_of(config);
  EXPECT_THAT(error, HasSubstr("viewpoints.list[1]: the robot would touch pillar"));
  EXPECT_THAT(error, HasSubstr("viewpoints.list[2]"));
}

// The same places, told from the board: no knowledge of the scene is needed.
TEST(Viewpoints, ListMayBeToldFromTheBoard) {
  const double facing_rad = 0.4;
  ViewpointSubject moved = subject();
  moved.T_scene_board = planar_pose(0.5, -0.3, facing_rad) * moved.T_scene_board;
  PillarWorld world;
  ViewpointConfig config = sampled();
  const ViewpointPlan drawn = plan_viewpoints(config, 5, moved, world, 3);
  config.planner = "list";
  config.list_frame = "board";
  for (const Viewpoint& stop : drawn.stops)
    config.list.push_back({stop.distance_m * std::cos(stop.bearing_rad), stop.distance_m * std::sin(stop.bearing_rad),
                           rad_to_deg(stop.yaw_rad - facing_rad)});
  const ViewpointPlan listed = plan_viewpoints(config, 5, moved, world, 3);
  ASSERT_EQ(listed.stops.size(), drawn.stops.size());
  for (std::size_t i = 0; i < drawn.stops.size(); ++i) {
    EXPECT_NEAR(listed.stops[i].x_m, drawn.stops[i].x_m, 1e-12);
    EXPECT_NEAR(listed.stops[i].y_m, drawn.stops[i].y_m, 1e-12);
    EXPECT_NEAR(wrap_angle(listed.stops[i].yaw_rad - drawn.stops[i].yaw_rad), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace rigproof
