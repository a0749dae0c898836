// Runs past more than one board: what is planned, told and true of them, and that pictures show it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_text.h"
#include "pose_near.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/validate/bound.h"
#include "rigproof/validate/proof.h"
#include "scenario.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The lab's board ahead, one to the left, an AprilGrid behind.
GenerateConfig around(const std::string& more = "", const std::string& of_second = "") {
  return parse_generate_config(
      "include: plain.yaml\nrig: cart_5x_mixed\nimage_scale: 0.5\nboard: {preset: charuco_7x5_100mm}\n"
      "more_boards:\n"
      "  - {preset: charuco_7x5_100mm, dictionary: DICT_4X4_50, x_m: 0, y_m: 4.3, facing_deg: -90" +
          of_second +
          "}\n"
          "  - {preset: aprilgrid_6x4_130mm, x_m: -4.3, y_m: 0, facing_deg: 0}\n" +
          more,
      "around.yaml");
}

TEST(SeveralBoardsOfARun, AreToldAndTrueEachByItself) {
  const Scenario scenario = resolve_scenario(
      around("poses: 12\nseed: 3\n", ", told_place_sigma_mm: 4, defects: {print_error_mm: 0.1, bow_mm: 2}"));
  const Rig& told = scenario.recording.rig;
  const Truth& truth = scenario.truth;
  ASSERT_EQ(told.boards(), 3);
  ASSERT_EQ(truth.boards(), 3);
  EXPECT_EQ(told.board_at(1).dictionary, "DICT_4X4_50");
  EXPECT_EQ(told.board_at(2).type, "aprilgrid");
  for (int b = 0; b < 3; ++b) {
    EXPECT_NE(told.board_at(b).square_m, truth.board_at(b).board.square_m) << b;
    EXPECT_NEAR(told.board_at(b).square_m / truth.board_at(b).board.square_m, 1.0, 0.03) << b;
    for (int a = 0; a < b; ++a)
      EXPECT_NE(told.board_at(a).square_m / truth.board_at(a).board.square_m,
                told.board_at(b).square_m / truth.board_at(b).board.square_m);
  }
  // Only the second one is bent, misprinted and measured.
  EXPECT_TRUE(truth.printed_corners.empty());
  EXPECT_EQ(static_cast<int>(truth.board_at(1).printed_corners.size()), told.board_at(1).corner_count());
  EXPECT_EQ(truth.drawn.at("more_boards[0].defects.bow_mm"), 2.0);
  EXPECT_EQ(truth.drawn.at("board.defects.bow_mm"), 0.0);
  EXPECT_EQ(told.board.print_sigma(), 0.0);
  EXPECT_GT(told.board_at(1).print_sigma(), 0.0);
  ASSERT_TRUE(told.board_at(1).place);
  EXPECT_FALSE(told.board_at(2).place);
  const BoardPlace& place = *told.board_at(1).place;
  EXPECT_NEAR(place.sigma_m, 0.004, 1e-15);
  EXPECT_NEAR(place.sigma_rad, deg_to_rad(0.5), 1e-15);
  const Rigid3 is = truth.T_world_board.inverse() * truth.board_at(1).T_world_board;
  const double off_m = (place.T_first_board.translation - is.translation).norm();
  EXPECT_GT(off_m, 1e-5);
  EXPECT_TRUE(IsPoseNear(is, place.T_first_board, 5.0 * 0.004, deg_to_rad(2.5)));
}

TEST(SeveralBoardsOfARun, AreSeenByTheCamerasThatLookElsewhere) {
  GenerateConfig alone = around("poses: 15\nviewpoints: {bearing_deg: {uniform: [-10, 10]}}\n");
  const Scenario several = resolve_scenario(alone);
  for (const CameraCoverage& camera : several.coverage) EXPECT_GE(camera.stops, 3U) << camera.camera;
  EXPECT_EQ(several.frame_count(), 15U * 5U);
}

// Where everything else is the same, one board's draws are the same with others beside it.
TEST(SeveralBoardsOfARun, LeaveTheFirstOneAsItIs) {
  GenerateConfig config = around("poses: 2\n");
  config.board.defects.print_error_mm = 0.1;
  const Scenario with = resolve_scenario(config);
  config.more_boards.clear();
  const Scenario without = resolve_scenario(config);
  EXPECT_EQ(with.truth.printed_corners, without.truth.printed_corners);
  EXPECT_EQ(with.recording.rig.board.square_m, without.recording.rig.board.square_m);
  EXPECT_EQ(with.world->description().T_world_board.translation,
            without.world->description().T_world_board.translation);
}

// The truth's world is laid into the ground that a loaded robot stands on: all boards with it.
TEST(SeveralBoardsOfARun, StandWhereTheyStandHoweverTheRobotLeans) {
  const Scenario scenario = resolve_scenario(
      around("poses: 3\nmotion: drive\ndrive: {payload_kg: 20, payload_x_m: 0.15, wheel_diameter_ratio: 1.01}\n"));
  ASSERT_TRUE(scenario.truth.T_robot_chassis);
  const WorldDescription& description = scenario.world->description();
  for (int b = 1; b < 3; ++b)
    EXPECT_TRUE(IsPoseNear(
        description.T_world_board.inverse() * description.board_at(static_cast<std::size_t>(b)).T_world_board,
        scenario.truth.T_world_board.inverse() * scenario.truth.board_at(b).T_world_board, 1e-9, 1e-9));
}

TEST(SeveralBoardsOfARun, MistakesAreNamed) {
  const auto error = [](const std::string& more_boards) {
    return error_text([&] {
      resolve_scenario(parse_generate_config("rig: husky_1x_d455\nposes: 1\nmore_boards: " + more_boards, "m.yaml"));
    });
  };
  EXPECT_THAT(
      error("[{preset: charuco_7x5_100mm}]"),
      AllOf(HasSubstr("more_boards[0].x_m"), HasSubstr("more_boards[0].y_m"), HasSubstr("more_boards[0].facing_deg")));
  const std::string at = "x_m: 0, y_m: 4.3, facing_deg: -90";
  EXPECT_THAT(error("[{preset: charuco_7x5_100mm, " + at + "}]"),
              HasSubstr("more_boards[0]: cannot be told from board in images: a plain"))
      << "the rig's board is a checkerboard";
  EXPECT_THAT(error("[{" + at + ", place: scene}]"), HasSubstr("more_boards[0].place"));
  EXPECT_THAT(error("[{preset: aprilgrid_6x4_130mm, dictionary: DICT_4X4_50, " + at + "}]"),
              HasSubstr("more_boards[0].dictionary: DICT_4X4_50: is of charuco boards"));
  std::string many = "[";
  for (int i = 0; i < 8; ++i) many += (i > 0 ? ", {" : "{") + at + "}";
  EXPECT_THAT(error(many + "]"), HasSubstr("more_boards: a list of 8: allowed are at most 7"));
  EXPECT_THAT(error("[{" + at + ", told_place_sigma_mm: 0.001}]"),
              HasSubstr("more_boards[0].told_place_sigma_mm: 0.001: must be 0 or at least 0.01"));
  EXPECT_THAT(error("[{" + at + ", told_place_sigma_deg: 1}]"), HasSubstr("needs told_place_sigma_mm beside it"));
  EXPECT_THAT(error("[{" + at + ", z_m: 1}]"), HasSubstr("more_boards[0].z_m"));
  EXPECT_THAT(error("[{type: charuco, dictionary: DICT_4X4, " + at + "}]"),
              HasSubstr("more_boards[0].dictionary: DICT_4X4: must be one of"));
}

TEST(SeveralBoardsOfARun, HaveNoLensFieldUnderExactIntrinsics) {
  const Scenario scenario =
      resolve_scenario(parse_generate_config("include: several_boards.yaml\nposes: 1\n", "one.yaml"));
  for (std::size_t i = 0; i < scenario.truth.cameras.size(); ++i) {
    const bool exact = scenario.recording.rig.cameras[i].intrinsics_sigma == IntrinsicsSigma::exact();
    EXPECT_NE(scenario.truth.cameras[i].lens_residual.has_value(), exact) << scenario.truth.cameras[i].name;
  }
}

// As shipped, in small: with everything that real cameras leave, before bent boards and a depth camera that is exact.
TEST(SeveralBoardsOfARun, AsShippedAreWhereTheTruthHasThem) {
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder.path() / "run";
  generate(parse_generate_config("include: several_boards.yaml\nimage_scale: 0.5\nposes: 8\n", "small.yaml"), options);
  const RunFolder run{options.output};
  const Recording recording = load_recording(run.recording());
  ObserveOptions observing;
  observing.threads = 2;
  const Proof proof = prove(recording, observe(recording, observing), load_truth(run.truth_file()));
  EXPECT_TRUE(proof.passed) << findings_json(proof.problems);
}

// Drawn coarsely, or with a driver's anisotropic filter, markers of small squares moved the corners of a whole row.
TEST(SeveralBoardsOfARun, AreDrawnFinelyEnoughForSmallSquares) {
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder.path() / "run";
  generate(
      parse_generate_config("include: [plain.yaml, several_boards.yaml]\nimage_scale: 0.5\nposes: 12\n", "small.yaml"),
      options);
  const RunFolder run{options.output};
  const Recording recording = load_recording(run.recording());
  ObserveOptions observing;
  observing.threads = 2;
  const Proof proof = prove(recording, observe(recording, observing), load_truth(run.truth_file()));
  for (const CameraProof& camera : proof.cameras)
    EXPECT_LT(camera.corner_rms_px.maxCoeff(), 0.022) << camera.camera << " " << camera.corner_rms_px.transpose();
}

// The loop closed: detected corners and depth of every board are where the truth has them.
TEST(SeveralBoardsOfARun, AreInThePicturesWhereTheTruthHasThem) {
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder.path() / "run";
  generate(around("poses: 6\nsensor_noise: none\nsensing: {told: exact}\n"), options);
  const RunFolder run{options.output};
  const Recording recording = load_recording(run.recording());
  const Truth truth = load_truth(run.truth_file());
  ObserveOptions observing;
  observing.threads = 2;
  const Observations observations = observe(recording, observing);
  std::vector<int> views(3);
  for (const BoardView& view : observations.board_views) ++views[static_cast<std::size_t>(view.board)];
  for (const int seen : views) EXPECT_GE(seen, 2);
  const Proof proof = prove(recording, observations, truth);
  EXPECT_TRUE(proof.passed) << findings_json(proof.problems);
  ASSERT_EQ(proof.cameras.size(), 5U);
  EXPECT_GT(proof.cameras[0].depth_pixels, 1000U);
  EXPECT_LT(proof.cameras[0].depth_rms_sigmas, 1.5) << "on the board";
  // A board that the truth has elsewhere is no slip of convention, and passes no proof.
  Truth moved = truth;
  moved.more_boards[0].T_world_board.translation.x() += 0.05;
  EXPECT_FALSE(prove(recording, observations, moved).passed);
  Truth fewer = truth;
  fewer.more_boards.clear();
  EXPECT_THAT(error_text([&] { prove(recording, observations, fewer); }), HasSubstr("more_boards: these are 3 boards"));
  EXPECT_TRUE(data_bound(observations, truth));
}

}  // namespace
}  // namespace rigproof
