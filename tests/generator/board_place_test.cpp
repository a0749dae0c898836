// Where the board stands, how it leans, and how it hangs on its stand are distributions of the configuration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "scenario.h"
#include "tiny_world.h"

namespace rigproof {
namespace {

/// What a run drew: metres and degrees.
struct DrawnBoard {
  Eigen::Vector3d centre_m;
  double lean_deg = 0.0, roll_deg = 0.0;
};

DrawnBoard drawn_by(const TinyWorld& world, int seed) {
  const GenerateConfig config =
      parse_generate_config("scene: " + world.scene() + "\nseed: " + std::to_string(seed) +
                                "\nrig: husky_1x_d455\nimage_scale: 0.1\n"
                                "viewpoints: {planner: list, list: [{x_m: 2, y_m: -1}]}\n"
                                "board: {place: given, x_m: {uniform: [4.2, 4.7]}, y_m: {uniform: [-0.4, 0.4]}, "
                                "z_m: {normal: {mean: 0.9, stddev: 0.05}}, facing_deg: 180, "
                                "lean_deg: {uniform: [5, 30]}, roll_deg: {choice: [-10, 10]}}\n",
                            "board.yaml");
  const Scenario scenario = resolve_scenario(config);
  const WorldDescription& description = scenario.world->description();
  const Rigid3& T = description.T_world_board;
  const Eigen::Vector3d towards_viewer = -(T.rotation * Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d right = T.rotation * Eigen::Vector3d::UnitX();
  return {T * description.board.centre(), rad_to_deg(std::asin(towards_viewer.z())), rad_to_deg(std::asin(right.z()))};
}

TEST(BoardPlace, InclinationAndMountingAreDrawnByTheSeed) {
  const TinyWorld world;
  constexpr int kSeeds = 12;
  double least = 90.0, most = -90.0;
  int anticlockwise = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const DrawnBoard board = drawn_by(world, seed);
    EXPECT_GE(board.centre_m.x(), 4.2);
    EXPECT_LE(board.centre_m.x(), 4.7);
    EXPECT_LE(std::abs(board.centre_m.y()), 0.4);
    EXPECT_NEAR(board.centre_m.z(), 0.9, 0.25);
    EXPECT_GE(board.lean_deg, 5.0);
    EXPECT_LE(board.lean_deg, 30.0);
    // The upper edge's slope: of a board that leans back by l, sin(10 deg) cos(l).
    EXPECT_NEAR(std::abs(std::sin(deg_to_rad(board.roll_deg))),
                std::sin(deg_to_rad(10.0)) * std::cos(deg_to_rad(board.lean_deg)), 1e-9);
    least = std::min(least, board.lean_deg);
    most = std::max(most, board.lean_deg);
    anticlockwise += board.roll_deg > 0.0;
  }
  EXPECT_GT(most - least, 10.0);
  EXPECT_GT(anticlockwise, 0);
  EXPECT_LT(anticlockwise, kSeeds);
  EXPECT_EQ(drawn_by(world, 3).centre_m, drawn_by(world, 3).centre_m);
}

}  // namespace
}  // namespace rigproof
