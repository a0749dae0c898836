#include "rigproof/geometric/geometric.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "error_text.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

Rigid3 T_camera_world(const GeometricRun& run, int stop, int camera) {
  return (run.truth.stops[static_cast<std::size_t>(stop)].T_world_robot *
          run.truth.cameras[static_cast<std::size_t>(camera)].T_robot_camera)
      .inverse();
}

TEST(Geometric, DependsOnTheSeedAlone) {
  GeometricConfig config;
  config.stops = 8;
  config.seed = 5;
  const GeometricRun a = draw_geometric_run(config), b = draw_geometric_run(config);
  config.seed = 6;
  const GeometricRun c = draw_geometric_run(config);
  ASSERT_EQ(a.observations.board_views.size(), b.observations.board_views.size());
  EXPECT_EQ(a.observations.board_views[3].corners[2].pixel, b.observations.board_views[3].corners[2].pixel);
  EXPECT_EQ(a.observations.stops[7].x_m, b.observations.stops[7].x_m);
  EXPECT_NE(a.observations.board_views[3].corners[2].pixel, c.observations.board_views[3].corners[2].pixel);
}

TEST(Geometric, TheFirstPoseIsTheWorld) {
  GeometricConfig config;
  config.stops = 3;
  const GeometricRun run = draw_geometric_run(config);
  const Rigid3& T = run.truth.stops.front().T_world_robot;
  EXPECT_NEAR(T.translation.norm(), 0.0, 1e-12);
  EXPECT_NEAR(yaw_of(T), 0.0, 1e-12);
}

TEST(Geometric, CornersScatterAsDeclared) {
  GeometricConfig config;
  config.corner_sigma_px = 0.2;
  const GeometricRun run = draw_geometric_run(config);
  double square = 0.0, sum = 0.0;
  int count = 0;
  for (const BoardView& view : run.observations.board_views) {
    const Rigid3 T = T_camera_world(run, view.stop, view.camera) * run.truth.T_world_board;
    for (const CornerObservation& corner : view.corners) {
      Eigen::Vector2d exact;
      ASSERT_TRUE(run.truth.cameras[0].camera.project(T * run.truth.board.corner(corner.id), &exact));
      square += (corner.pixel - exact).squaredNorm();
      sum += (corner.pixel - exact).sum();
      count += 2;
    }
  }
  EXPECT_EQ(count, 3 * 100 * 12 * 2);  // every camera sees the whole board from every stop
  // 7200 samples: sigma to 0.8 %, mean to 0.0024 px; four times that.
  EXPECT_NEAR(std::sqrt(square / count), 0.2, 0.007);
  EXPECT_NEAR(sum / count, 0.0, 0.01);
}

TEST(Geometric, PlanesScatterAsDeclared) {
  GeometricConfig config;
  config.depth_scale_sigma = 0.003;
  const GeometricRun run = draw_geometric_run(config);
  double chi2 = 0.0;
  for (const PlaneObservation& plane : run.observations.ground_planes) {
    const Rigid3 T = T_camera_world(run, plane.stop, plane.camera);
    const Eigen::Vector3d up = T.rotation * Eigen::Vector3d::UnitZ();
    const double height = -up.dot(T.translation);
    const double scale = *run.truth.cameras[static_cast<std::size_t>(plane.camera)].depth_scale;
    const Eigen::Vector3d residual = plane.inverse_depth_plane + up / (height * scale);
    chi2 += residual.dot(plane.covariance_per_m2.ldlt().solve(residual));
  }
  const double expected = 3.0 * static_cast<double>(run.observations.ground_planes.size());
  EXPECT_GT(expected, 0.0);
  EXPECT_NEAR(chi2 / expected, 1.0, 4.0 * std::sqrt(2.0 / expected));
}

TEST(Geometric, RandomStopsAreAsFarApartAsStated) {
  GeometricConfig config;
  config.stops = 400;
  const GeometricScene scene = draw_scene(config);
  double distance = 0.0, turn = 0.0;
  for (std::size_t i = 1; i < scene.T_world_robot.size(); ++i) {
    const Rigid3 step = scene.T_world_robot[i - 1].inverse() * scene.T_world_robot[i];
    distance += step.translation.norm() / 399.0;
    turn += std::abs(yaw_of(step)) / 399.0;
  }
  EXPECT_NEAR(distance, 1.65, 0.2);
  EXPECT_NEAR(rad_to_deg(turn), 24.0, 6.0);
}

TEST(Geometric, StepsAreAsLongAsStated) {
  GeometricConfig config;
  config.stops = 200;
  config.drive = GeometricDrive::kSteps;
  const GeometricScene scene = draw_scene(config);
  double distance = 0.0, turn = 0.0;
  for (std::size_t i = 1; i < scene.T_world_robot.size(); ++i) {
    const Rigid3 step = scene.T_world_robot[i - 1].inverse() * scene.T_world_robot[i];
    distance += step.translation.norm() / 199.0;
    turn += std::abs(yaw_of(step)) / 199.0;
  }
  EXPECT_NEAR(distance, 0.3, 0.05);
  EXPECT_NEAR(rad_to_deg(turn), 8.0, 2.5);
}

// Root mean square of what the odometry says about increments, less the truth.
Eigen::Vector2d increment_noise(const GeometricRun& run) {
  Eigen::Vector2d square = Eigen::Vector2d::Zero();
  for (std::size_t i = 1; i < run.truth.stops.size(); ++i) {
    const Stop &a = run.observations.stops[i - 1], &b = run.observations.stops[i];
    const Rigid3 measured = planar_pose(a.x_m, a.y_m, a.yaw_rad).inverse() * planar_pose(b.x_m, b.y_m, b.yaw_rad);
    const Rigid3 exact = run.truth.stops[i - 1].T_world_robot.inverse() * run.truth.stops[i].T_world_robot;
    square[0] += 0.5 * (measured.translation - exact.translation).squaredNorm();
    square[1] += std::pow(wrap_angle(yaw_of(measured) - yaw_of(exact)), 2);
  }
  return (square / static_cast<double>(run.truth.stops.size() - 1)).cwiseSqrt();
}

TEST(Geometric, OdometryScattersAsDeclared) {
  GeometricConfig config;
  config.stops = 400;
  config.lambda = 2.0;
  const Eigen::Vector2d increments = increment_noise(draw_geometric_run(config));
  // 400 increments: 3.5 % for the yaw; four times that.
  EXPECT_NEAR(increments[0], 0.004, 0.0005);
  EXPECT_NEAR(increments[1], 0.02, 0.003);
  config.odometry_model = OdometryModel::kPerPose;
  const GeometricRun run = draw_geometric_run(config);
  double square = 0.0;
  for (std::size_t i = 0; i < 400; ++i)
    square += std::pow(run.observations.stops[i].x_m - run.truth.stops[i].T_world_robot.translation.x(), 2) / 400.0;
  EXPECT_NEAR(std::sqrt(square), 0.004, 0.0006);
}

TEST(Geometric, EveryRandomRigIsSeenByItsTurns) {
  for (int i = 0; i < 20; ++i) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(i);
    config.rig = random_rig(config.seed, 1 + i % 8);
    config.stops = 16;
    const GeometricRun run = draw_geometric_run(config);
    std::vector<int> seen(run.truth.cameras.size(), 0);
    for (const BoardView& view : run.observations.board_views) ++seen[static_cast<std::size_t>(view.camera)];
    for (const int count : seen) EXPECT_GE(count, 2) << "seed " << i;
  }
}

TEST(Geometric, ImpossibleConfigurationsAreNamed) {
  GeometricConfig config;
  config.stops = 0;
  config.lambda = -1.0;
  const std::string problems = error_text([&] { draw_geometric_run(config); });
  EXPECT_NE(problems.find("stops"), std::string::npos);
  EXPECT_NE(problems.find("lambda"), std::string::npos);
}

}  // namespace
}  // namespace rigproof
