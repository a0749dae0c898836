// Worlds with more than one board.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigproof/core/conventions.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/renderer.h"

namespace rigproof {
namespace {

using testing::Contains;

// The lab's board ahead, and an AprilGrid to its right, turned by as much.
WorldDescription two_boards() {
  const SceneModel scene = load_scene_model("indoor_lab");
  const RigModel rig = load_rig_model("husky_1x_d455");
  WorldDescription description =
      describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 3);
  description.cameras[0].camera = Camera::symmetric(320, 240, 150.0);
  WorldBoard second;
  second.board.type = "aprilgrid";
  second.board.squares_x = second.board.squares_y = 4;
  second.board.square_m = 0.15;
  second.T_world_board = place_board(second.board, {3.0, -2.0, 0.6, 135.0, 0.0, 0.0});
  description.more_boards.push_back(second);
  return description;
}

TEST(TwoBoards, AreMetByRaysEachByItsNumber) {
  const WorldDescription description = two_boards();
  const auto world = World::compose(description);
  const Eigen::Vector3d eye(1.5, 0.0, 0.7);
  for (std::size_t b = 0; b < 2; ++b) {
    const WorldBoard& board = description.board_at(b);
    const Eigen::Vector3d to_centre = board.T_world_board * board.board.centre() - eye;
    EXPECT_EQ(world->cast_ray_to_board(eye, to_centre), b);
    ObjectKind kind = ObjectKind::kNothing;
    world->cast_ray(eye, to_centre, &kind);
    EXPECT_EQ(kind, ObjectKind::kBoard);
  }
  EXPECT_EQ(world->cast_ray_to_board(eye, {0.0, 0.0, -1.0}), std::nullopt);
  const Eigen::Vector3d second = description.more_boards[0].T_world_board.translation;
  world->place_robot(planar_pose(second.x(), second.y(), 0.0));
  EXPECT_THAT(world->collisions(), Contains("rigproof_stand_2"));
}

RenderedView view_of(const WorldDescription& description, const RenderOptions& options) {
  const auto world = World::compose(description);
  world->place_robot(planar_pose(1.2, -0.6, -0.35));
  RenderedView view;
  Renderer(*world, options).render(0, &view);
  return view;
}

std::size_t pixels_that_differ(const Image8& a, const Image8& b, int first_column, int end_column) {
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = first_column; x < end_column; ++x)
      for (int c = 0; c < 3; ++c) count += a.at(x, y, c) != b.at(x, y, c);
  return count;
}

// Each in its own part of the image.
TEST(TwoBoards, AreBothDrawnAtDoubleTheResolution) {
  const WorldDescription description = two_boards();
  RenderOptions fine, coarse;
  coarse.board_at_double = false;
  const Image8 sharp = view_of(description, fine).color, plain = view_of(description, coarse).color;
  WorldDescription without = description;
  without.more_boards.clear();
  const Image8 alone = view_of(without, fine).color;
  const int half = sharp.width / 2, all = sharp.width;
  EXPECT_GT(pixels_that_differ(sharp, alone, half, all), 1000U) << "the second one is there";
  EXPECT_GT(pixels_that_differ(sharp, plain, 0, half), 300U);
  EXPECT_GT(pixels_that_differ(sharp, plain, half, all), 300U);
  EXPECT_EQ(pixels_that_differ(sharp, view_of(description, fine).color, 0, all), 0U);
}

TEST(TwoBoards, ArePartOfWhatPicturesDependOn) {
  const WorldDescription description = two_boards();
  const std::string hash = World::compose(description)->content_hash();
  EXPECT_EQ(World::compose(description)->content_hash(), hash);
  WorldDescription moved = description, bowed = description;
  moved.more_boards[0].T_world_board.translation.x() += 1e-3;
  bowed.more_boards[0].board_defects.bow_m = 1e-3;
  EXPECT_NE(World::compose(moved)->content_hash(), hash);
  EXPECT_NE(World::compose(bowed)->content_hash(), hash);
}

}  // namespace
}  // namespace rigproof
