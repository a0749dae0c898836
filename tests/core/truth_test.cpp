#include "rigproof/truth/truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "pose_near.h"
#include "rigproof/truth/stop_at.h"
#include "sample_truth.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

TEST(Truth, RoundTripKeepsEveryValueAndEveryByte) {
  const TempFolder folder;
  const Truth a = sample_truth();
  save_truth(a, folder / "a.yaml");
  const Truth b = load_truth(folder / "a.yaml");
  EXPECT_EQ(a.scene, b.scene);
  EXPECT_EQ(a.seed, b.seed) << "all 64 bits";
  EXPECT_EQ(a.board, b.board);
  ASSERT_EQ(b.cameras.size(), 2U);
  EXPECT_EQ(b.cameras[0].name, "left");
  EXPECT_EQ(a.cameras[0].camera.distortion, b.cameras[0].camera.distortion);
  EXPECT_EQ(a.cameras[0].depth_scale, b.cameras[0].depth_scale);
  EXPECT_FALSE(b.cameras[1].depth_scale);
  EXPECT_TRUE(IsPoseNear(a.cameras[1].T_robot_camera, b.cameras[1].T_robot_camera, 0.0, 1e-15));
  ASSERT_EQ(b.stops.size(), a.stops.size());
  EXPECT_EQ(a.stops[2].stamp_s, b.stops[2].stamp_s);
  EXPECT_EQ(a.odometry_scale, b.odometry_scale);
  EXPECT_EQ(a.odometry_noise.sigma_xy_m, b.odometry_noise.sigma_xy_m);
  EXPECT_EQ(a.drawn, b.drawn);
  save_truth(b, folder / "b.yaml");
  EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
}

TEST(Truth, ACameraMayHaveStopsOfItsOwn) {
  const TempFolder folder;
  Truth a = sample_truth();
  a.cameras[1].stops = {a.stops[0], a.stops[1]};
  a.cameras[1].stops[1].stamp_s += 0.015;
  a.cameras[1].stops[1].velocity = Vector6d::Constant(0.25);
  save_truth(a, folder / "a.yaml");
  const Truth b = load_truth(folder / "a.yaml");
  EXPECT_TRUE(b.cameras[0].stops.empty());
  EXPECT_EQ(b.stops_of(0).size(), 3U) << "those of all";
  ASSERT_EQ(b.stops_of(1).size(), 2U);
  EXPECT_EQ(b.stops_of(1)[1].stamp_s, a.stops[1].stamp_s + 0.015);
  EXPECT_EQ(b.stops_of(1)[1].velocity, a.cameras[1].stops[1].velocity);
  EXPECT_TRUE(IsPoseNear(b.stops_of(1)[0].T_world_robot, a.stops[0].T_world_robot, 0.0, 1e-15));
  save_truth(b, folder / "b.yaml");
  EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
}

TEST(Truth, LensResidualPrintedCornersAndStanceAreKept) {
  const TempFolder folder;
  Truth a = sample_truth();
  a.cameras[0].lens_residual = draw_lens_residual(a.cameras[0].camera, 0.07, 8.0, RandomStream(1, "field"));
  a.T_robot_chassis = se3_exp((Vector6d() << 0.0, 0.0, -0.003, -0.001, 0.002, 0.0).finished());
  for (int id = 0; id < a.board.corner_count(); ++id)
    a.printed_corners.push_back(a.board.corner(id) + Eigen::Vector3d(1e-4 * id, -2e-5, 3e-5));
  save_truth(a, folder / "a.yaml");
  const Truth b = load_truth(folder / "a.yaml");
  ASSERT_TRUE(b.cameras[0].lens_residual);
  EXPECT_FALSE(b.cameras[1].lens_residual);
  EXPECT_EQ(b.cameras[0].lens_residual->dx_px, a.cameras[0].lens_residual->dx_px);
  EXPECT_EQ(b.cameras[0].lens_residual->at({100.0, 50.0}), a.cameras[0].lens_residual->at({100.0, 50.0}));
  EXPECT_EQ(b.printed_corners, a.printed_corners);
  ASSERT_TRUE(b.T_robot_chassis);
  EXPECT_LT(se3_log(a.T_robot_chassis->inverse() * *b.T_robot_chassis).norm(), 1e-12);
  EXPECT_EQ(b.corner(3), a.printed_corners[3]);
  EXPECT_EQ(sample_truth().corner(3), a.board.corner(3));
  save_truth(b, folder / "b.yaml");
  EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
}

TEST(Truth, BoardsThatStandElsewhereAreKept) {
  const TempFolder folder;
  Truth a = sample_truth();
  RandomStream random(6, "places");
  Board grid;
  grid.type = "aprilgrid";
  a.more_boards = {{grid, {}, random_transform(random)}, {a.board, a.board.corners(), random_transform(random)}};
  a.more_boards[1].printed_corners[2].x() += 1e-3;
  save_truth(a, folder / "a.yaml");
  const Truth b = load_truth(folder / "a.yaml");
  ASSERT_EQ(b.boards(), 3);
  EXPECT_EQ(b.board_at(0).board, a.board);
  EXPECT_EQ(b.board_at(1).board, grid);
  EXPECT_TRUE(IsPoseNear(b.board_at(1).T_world_board, a.more_boards[0].T_world_board, 0.0, 1e-15));
  EXPECT_EQ(b.board_at(2).corner(2), a.more_boards[1].printed_corners[2]);
  EXPECT_THROW(b.board_at(3), std::out_of_range);
  save_truth(b, folder / "b.yaml");
  EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
  save_truth(sample_truth(), folder / "one.yaml");
  EXPECT_EQ(folder.read("one.yaml").find("more_boards"), std::string::npos);
}

TEST(Truth, DamagedLensResidualsAndCornersAreNamed) {
  const TempFolder folder;
  Truth a = sample_truth();
  a.printed_corners.emplace_back(0.0, 0.0, 0.0);
  a.cameras[0].lens_residual = LensResidual{100.0, 5, std::vector<double>(20, 0.1), std::vector<double>(25, 0.1)};
  save_truth(a, folder / "a.yaml");
  const std::string text = error_text([&] { load_truth(folder / "a.yaml"); });
  EXPECT_THAT(text, HasSubstr("printed_corners_m: "));
  EXPECT_THAT(text, HasSubstr("must have a corner of the board in each line: " +
                              std::to_string(sample_truth().board.corner_count())));
  EXPECT_THAT(text, HasSubstr("dx_px and dy_px must have as many numbers"));
}

TEST(Truth, ProblemsAreNamed) {
  const TempFolder folder;
  folder.write("t.yaml",
               "format: rigproof-truth\nversion: 1\nseed: -1\nstops: 5\n"
               "cameras: {left: {depth_scale: 50, stops: [{stamp_s: late}]}}\n"
               "drawn: {board.bow_mm: much}\n");
  const std::string text = error_text([&] { load_truth(folder / "t.yaml"); });
  for (const char* part : {"t.yaml:3: seed: -1: must be a whole number, >= 0", "t.yaml:4: stops: 5: must be a list",
                           "cameras.left.depth_scale: 50: allowed is 0.1 to 10", "cameras.left.stops[0].stamp_s: late",
                           "drawn.board.bow_mm: much: must be a finite number",
                           "cameras.left.T_robot_camera: is missing", "T_world_board: is missing", "board: is missing"})
    EXPECT_THAT(text, HasSubstr(part));
}

// The first row is read half a readout before the middle one, the last row half a readout after it.
TEST(Truth, ACornerIsSeenWhenItsRowIsRead) {
  Truth truth = sample_truth();
  TrueCamera& camera = truth.cameras[0];
  TrueStop stop = truth.stops[0];
  truth.T_world_board =
      stop.T_world_robot * camera.T_robot_camera * Rigid3(Eigen::Quaterniond::Identity(), {0, 0, 1.5});
  camera.sensing["readout_ms"] = 20.0;
  stop.velocity = (Vector6d() << 0.5, 0.1, 0.0, 0.02, -0.01, 0.8).finished();
  const double last_row = camera.camera.height_px - 0.5;
  for (const auto& [row, late_s] :
       {std::pair(-0.5, -0.01), std::pair(0.5 * (last_row - 0.5), 0.0), std::pair(last_row, 0.01)}) {
    const Rigid3 T_camera_board =
        (stop.T_world_robot * se3_exp(late_s * *stop.velocity) * camera.T_robot_camera).inverse() * truth.T_world_board;
    Eigen::Vector2d pixel, expected;
    ASSERT_TRUE(camera.project(T_camera_board * truth.corner(3), &expected));
    ASSERT_TRUE(truth.project_corner(0, stop, truth, 3, row, &pixel));
    EXPECT_NEAR((pixel - expected).norm(), 0.0, 1e-9) << row;
  }
  Eigen::Vector2d pixel;
  truth.T_world_board =
      stop.T_world_robot * camera.T_robot_camera * Rigid3(Eigen::Quaterniond::Identity(), {0, 0, -1.5});
  EXPECT_FALSE(truth.project_corner(0, stop, truth, 3, 0.0, &pixel)) << "behind the camera";
}

TEST(Truth, StopsAreFoundByTheirStamps) {
  Truth truth;
  for (const double stamp_s : {1.0, 3.0, 3.2}) truth.stops.push_back({stamp_s, planar_pose(stamp_s, 0.0, 0.0)});
  EXPECT_EQ(stop_at(truth.stops, 1.4), 0U);
  EXPECT_EQ(stop_at(truth.stops, 1.6), std::nullopt);  // half a second
  EXPECT_EQ(stop_at(truth.stops, 3.09), 1U);
  EXPECT_EQ(stop_at(truth.stops, 3.35), std::nullopt);  // half the distance of two stops
  EXPECT_EQ(stop_at({}, 1.0), std::nullopt);
  EXPECT_EQ(robot_at(truth, 3.18)->translation.x(), 3.2);
  EXPECT_FALSE(robot_at(truth, 2.0).has_value());
  truth.cameras.resize(1);
  truth.cameras[0].stops.push_back({3.17, planar_pose(7.0, 0.0, 0.0)});
  EXPECT_EQ(robot_at(truth, 3.18)->translation.x(), 7.0);
}

}  // namespace
}  // namespace rigproof
