// The default plan: every camera its share, cameras together where they can, the board all over each image.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "board_height.h"
#include "error_text.h"
#include "pillar_world.h"
#include "places.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/coverage.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

// A board of 0.5 x 0.4 m that stands low, so that the distance moves it through the rows.
ViewpointSubject low_board(std::vector<WorldCamera> cameras) {
  ViewpointSubject low = subject();
  low.cameras = std::move(cameras);
  low.T_scene_board.translation.z() -= 0.4;
  return low;
}

std::vector<WorldCamera> all_round() {
  return {camera_at(0.2, 0.7, 10.0, 14.0), camera_at(-0.2, 0.7, -10.0, 14.0), camera_at(0.0, 0.6, 95.0, 12.0),
          camera_at(0.0, 0.6, 178.0, 10.0)};
}

struct Planned {
  ViewpointPlan plan;
  std::vector<CameraCoverage> seen, possible;
};

Planned planned(const ViewpointSubject& subject, std::int64_t poses, const ViewpointConfig& config = {}) {
  PillarWorld world;
  Planned result{plan_viewpoints(config, poses, subject, world, 5), {}, possible_coverage(config, subject, world)};
  std::vector<Rigid3> places;
  for (const Viewpoint& stop : result.plan.stops) places.push_back(stop.T_scene_robot());
  result.seen = coverage_of(places, config, subject, world);
  return result;
}

TEST(Covering, EveryCameraGetsItsShareAndPairsSeeTheBoardTogether) {
  const Planned result = planned(low_board(all_round()), 24);
  ASSERT_EQ(result.plan.stops.size(), 24U);
  int together = 0;
  for (const Viewpoint& stop : result.plan.stops) {
    EXPECT_GE(stop.cameras_with_board, 1);
    together += stop.cameras_with_board > 1;
  }
  // Four cameras, of which two look the same way: an equal share would be 6.
  for (const CameraCoverage& camera : result.seen) EXPECT_GE(camera.stops, 4U);
  EXPECT_GE(together, 24 / 4);
}

TEST(Covering, TheBoardComesToLieWhereverItCan) {
  const Planned result = planned(low_board(subject().cameras), 40);
  ViewpointConfig before;
  before.planner = "sampled";
  const Planned of_before = planned(low_board(subject().cameras), 40, before);
  for (std::size_t i = 0; i < result.seen.size(); ++i) {
    EXPECT_GE(10 * result.seen[i].cells, 7 * result.possible[i].cells);
    EXPECT_GT(result.seen[i].cells, of_before.seen[i].cells);
    EXPECT_GT(result.seen[i].bottom_row_px - result.seen[i].top_row_px, 200.0);
  }
}

// From no place in front of the one does a camera see the other.
TEST(Covering, BoardsThatFaceEachOtherAreShownToAllCamerasWithoutTurningAround) {
  ViewpointSubject facing = low_board(all_round());
  const Rigid3 about = planar_pose(2.0, 0.0, 0.0) * planar_pose(0.0, 0.0, kPi) * planar_pose(-2.0, 0.0, 0.0);
  facing.more_boards = {{facing.board, about * facing.T_scene_board, facing.board_margin_m}};
  const Planned result = planned(facing, 24);
  for (const CameraCoverage& camera : result.seen) EXPECT_GE(camera.stops, 4U) << camera.camera;
  PillarWorld world;
  const Places places({}, facing, world);
  std::map<std::size_t, int> views;
  for (const Viewpoint& stop : result.plan.stops) {
    EXPECT_LT(stop.distance_m, 3.7) << "of the nearest board";
    for (const Sight& sight : places.seeing(stop)) ++views[sight.board];
  }
  EXPECT_GE(views[0], 6);
  EXPECT_GE(views[1], 6);
}

// As of an image the one counts that has most corners.
TEST(Covering, OfBoardsInOneImageTheLargerOneCounts) {
  ViewpointSubject both = subject();
  ViewedBoard larger{both.board, both.T_scene_board, both.board_margin_m};
  larger.board.squares_x += 1;
  larger.T_scene_board.translation.y() += 0.1;
  both.more_boards = {larger};
  PillarWorld world;
  const Places places({}, both, world);
  const Viewpoint stop = places.place(2.4, 0.1, 0.0);
  ASSERT_FALSE(places.seeing(stop).empty());
  for (const Sight& sight : places.seeing(stop)) EXPECT_EQ(sight.board, 1U) << sight.camera;
  both.more_boards[0].board.squares_x = both.board.squares_x;
  for (const Sight& sight : Places({}, both, world).seeing(stop)) EXPECT_EQ(sight.board, 0U) << "of equals the first";
}

// The bound is one: a plan of other places does not exceed it by more than the cells that lie between those tried.
TEST(Covering, NoPlanShowsMoreThanIsPossible) {
  const Planned result = planned(low_board(all_round()), 200);
  for (std::size_t i = 0; i < result.seen.size(); ++i) {
    EXPECT_LE(result.seen[i].cells, result.possible[i].cells + 2);
    EXPECT_GE(result.seen[i].top_row_px, result.possible[i].top_row_px - 10.0);
    EXPECT_LE(result.seen[i].bottom_row_px, result.possible[i].bottom_row_px + 10.0);
  }
}

// "30 of 48 (possible: 29)" is nothing to tell: what a plan shows counts, though the places tried miss it.
TEST(Covering, WhatAPlanShowsIsPossible) {
  ViewpointConfig config;
  const double near_m = config.distance_m.lowest();
  config.distance_m = 2.0 * near_m;
  const ViewpointSubject all = low_board(all_round());
  PillarWorld world;
  const std::vector<CameraCoverage> from_anywhere = possible_coverage(config, all, world);
  const Rigid3 near = Places(config, all, world).place(near_m, 0.0, 0.0).T_scene_robot();
  const std::vector<CameraCoverage> seen = coverage_of({near}, config, all, world);
  const std::vector<CameraCoverage> possible = possible_coverage(config, all, world, {near});
  bool more = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_GE(possible[i].cells, from_anywhere[i].cells);
    if (seen[i].cells == 0) continue;
    EXPECT_LE(possible[i].top_row_px, seen[i].top_row_px);
    EXPECT_GE(possible[i].bottom_row_px, seen[i].bottom_row_px);
    more = more || possible[i].cells > from_anywhere[i].cells;
  }
  EXPECT_TRUE(more) << "the place adds nothing to show";
}

TEST(Covering, MoreStopsLeaveTheFirstOnesWhereTheyAre) {
  ViewpointConfig config;
  config.order = "drawn";
  const std::vector<Viewpoint> few = planned(low_board(all_round()), 6, config).plan.stops;
  const std::vector<Viewpoint> many = planned(low_board(all_round()), 12, config).plan.stops;
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].x_m, many[i].x_m);
    EXPECT_EQ(few[i].yaw_rad, many[i].yaw_rad);
  }
  PillarWorld world;
  const auto next = draw_viewpoint(config, 6, low_board(all_round()), world, few, 5);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->x_m, many[6].x_m);
}

TEST(Covering, SaysWhatNoCameraCanBeShown) {
  const std::vector<WorldCamera> up = {camera_at(0.0, 0.7, 0.0, 12.0), camera_at(0.0, 0.7, 0.0, -60.0)};
  const Planned result = planned(low_board(up), 6);
  EXPECT_EQ(describe_camera(result.seen[1], result.possible[1], 6),
            "board in 0 of 6: from no place is it whole in the image");
  EXPECT_THAT(describe_camera(result.seen[0], result.possible[0], 6), HasSubstr("board in 6 of 6, in "));
  PillarWorld world;
  EXPECT_THAT(error_text([&] { plan_viewpoints({}, 6, low_board({up[1]}), world, 0); }), HasSubstr("whole board"));
}

TEST(FittedHeight, ShowsTheBoardToCamerasThatLookDown) {
  const Board board;
  BoardPlacement placement{4.4, 0.3, 0.8, 170.0, 10.0, 3.0};
  const BoardPlacement fitted = at_fitting_height(placement, all_round(), board, 0.05);
  EXPECT_LT(fitted.z_m, 0.6);
  EXPECT_GT(fitted.z_m, 0.2);
  placement.z_m = fitted.z_m;
  EXPECT_EQ(std::tie(fitted.x_m, fitted.y_m, fitted.facing_deg, fitted.lean_deg, fitted.roll_deg),
            std::tie(placement.x_m, placement.y_m, placement.facing_deg, placement.lean_deg, placement.roll_deg));
  // Another camera, another height: one that looks ahead sees a low board in its lower half only.
  const BoardPlacement for_low = at_fitting_height(placement, {camera_at(0.0, 1.2, 0.0, 0.0)}, board, 0.05);
  EXPECT_GT(for_low.z_m, fitted.z_m);
}

}  // namespace
}  // namespace rigproof
