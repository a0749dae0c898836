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

// Errors that repeat in every image: the truth has them, the recording grants what a stranger would and tells no more.
TEST(RepeatingErrors, AreInTheTruthAndGrantedByTheRecording) {
  const TinyWorld world;
  const auto resolved = [&world](const std::string& more) {
    return resolve_scenario(parse_generate_config(
        "scene: " + world.scene() + "\nrig: husky_1x_d455\nimage_scale: 0.1\nposes: 1\n" + more, "repeat.yaml"));
  };
  const Scenario without = resolved("include: plain.yaml\n");
  EXPECT_FALSE(without.truth.cameras[0].lens_residual);
  EXPECT_TRUE(without.truth.printed_corners.empty());
  EXPECT_EQ(without.recording.rig.cameras[0].intrinsics_sigma.residual_px, 0.0);
  const Scenario with =
      resolved("render: {lens_residual: true}\nboard: {defects: {bow_mm: 0, print_error_mm: 0.08}}\n");
  ASSERT_TRUE(with.truth.cameras[0].lens_residual);
  const double rms_px = with.truth.cameras[0].sensing.at("lens_residual_px");
  EXPECT_GT(rms_px, 0.0);
  EXPECT_GT(with.recording.rig.cameras[0].intrinsics_sigma.residual_px, 0.0);
  EXPECT_GT(with.recording.rig.board.print_sigma(), 0.0);
  const Board& board = with.truth.board;
  ASSERT_EQ(static_cast<int>(with.truth.printed_corners.size()), board.corner_count());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0.0, turn = 0.0, size_x = 0.0, size_y = 0.0;
  for (int id = 0; id < board.corner_count(); ++id) {
    const Eigen::Vector3d shift = with.truth.corner(id) - board.corner(id), place = board.corner(id) - board.centre();
    sum += shift;
    squares += shift.head<2>().squaredNorm();
    turn += place.x() * shift.y() - place.y() * shift.x();
    size_x += place.x() * shift.x();
    size_y += place.y() * shift.y();
  }
  EXPECT_NEAR(std::sqrt(0.5 * squares / board.corner_count()), 8e-5, 1e-12);
  for (const double whole : {sum.x(), sum.y(), sum.z(), turn, size_x, size_y}) EXPECT_NEAR(whole, 0.0, 1e-12);
}

// A smaller image of the same lens: what it errs by is as many pixels fewer, and so is what is said of it.
TEST(RepeatingErrors, OfSmallerImagesAreFewerPixelsAndSaidToBe) {
  const TinyWorld world;
  const auto resolved = [&world](const std::string& scale) {
    return resolve_scenario(parse_generate_config("scene: " + world.scene() + "\nrig: husky_1x_d455\nimage_scale: " +
                                                      scale + "\nposes: 1\nrender: {lens_residual: true}\n",
                                                  "small.yaml"));
  };
  const Scenario whole = resolved("1.0"), small = resolved("0.1");
  const auto rms_px = [](const Scenario& scenario) { return scenario.truth.cameras[0].sensing.at("lens_residual_px"); };
  EXPECT_NEAR(rms_px(small), 0.1 * rms_px(whole), 1e-12);
  const IntrinsicsSigma& said = small.recording.rig.cameras[0].intrinsics_sigma;
  IntrinsicsSigma expected = whole.recording.rig.cameras[0].intrinsics_sigma;
  ASSERT_GT(expected.residual_px, 0.0);
  for (double* each_px : {&expected.residual_px, &expected.principal_point_px, &expected.distortion_px})
    *each_px *= 0.1;
  EXPECT_TRUE(said == expected);
}

}  // namespace
}  // namespace rigproof
