#include "rigproof/calib/geometry/pnp.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "board_picture.h"
#include "pose_near.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "trials.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;

const Board kBoard{"checkerboard", 5, 4, 0.1, {}, {}, {}};

std::vector<Camera> cameras() {
  Camera pinhole = Camera::symmetric(1280, 720, 640.0);
  pinhole.fy_px = 655.0;
  pinhole.cx_px = 610.0;
  Camera brown = pinhole;
  brown.lens = Lens::kBrownConrady;
  brown.distortion = {-0.3, 0.09, 0.0005, -0.0004, -0.01};
  Camera fisheye = pinhole;
  fisheye.lens = Lens::kKannalaBrandt;
  fisheye.distortion = {-0.02, 0.004, -0.001, 0.0002, 0.0};
  return {pinhole, brown, fisheye};
}

std::vector<CornerObservation> exact_corners(const Camera& camera, const Rigid3& T, double sigma_px) {
  std::vector<CornerObservation> corners;
  const std::vector<Vector2d> pixels = true_corners(camera, kBoard, T);
  for (int id = 0; id < static_cast<int>(pixels.size()); ++id)
    corners.push_back({id, pixels[static_cast<std::size_t>(id)], Eigen::Matrix2d::Identity() * sigma_px * sigma_px});
  return corners;
}

TEST(BoardPose, RecoversExactPosesThroughEveryLens) {
  RandomStream random(1, "poses");
  for (const Camera& camera : cameras()) {
    for (int i = 0; i < 50; ++i) {
      const Rigid3 T =
          board_in_view(camera, kBoard, random.uniform(0.7, 4.0), random.uniform(0.1, 1.1), random.uniform(0.0, 6.28),
                        random.uniform(0.0, 6.28), {random.uniform(300.0, 900.0), random.uniform(200.0, 520.0)});
      const auto pose = estimate_board_pose(exact_corners(camera, T, 0.1), kBoard, camera);
      ASSERT_TRUE(pose.has_value());
      EXPECT_TRUE(IsPoseNear(T, pose->T_camera_board, 1e-8, 1e-8));
      EXPECT_LT(pose->reprojection_rms_px, 1e-8);
      EXPECT_GT(pose->ambiguity_ratio, 10.0);
    }
  }
}

TEST(BoardPose, CovarianceMatchesMonteCarloOverTrials) {
  const Trials trials(100, 400);
  const double sigma_px = 0.1;
  for (const Camera& camera : cameras()) {
    const Rigid3 T = board_in_view(camera, kBoard, 1.8, 0.7, 0.9, 0.4, {700.0, 300.0});
    const std::vector<CornerObservation> exact = exact_corners(camera, T, sigma_px);
    RandomStream random(2, "pixel noise");
    double nees = 0.0;
    Matrix6d scatter = Matrix6d::Zero();
    Matrix6d stated = Matrix6d::Zero();
    for (int trial = 0; trial < trials.count(); ++trial) {
      std::vector<CornerObservation> corners = exact;
      for (CornerObservation& corner : corners) corner.pixel += sigma_px * Vector2d(random.normal(), random.normal());
      const auto pose = estimate_board_pose(corners, kBoard, camera);
      ASSERT_TRUE(pose.has_value());
      const Vector6d error = transform_error(pose->T_camera_board, T);
      nees += error.dot(pose->covariance.ldlt().solve(error)) / trials.count();
      scatter += error * error.transpose() / trials.count();
      stated += pose->covariance / trials.count();
    }
    // 6 degrees of freedom; the mean of 400 has a standard deviation of 0.17, four of them allowed.
    EXPECT_NEAR(nees, 6.0, trials.tolerance(0.7));
    // Each sigma from 400 trials is good to 3.5 %; four of them.
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(scatter(i, i) / stated(i, i)), 1.0, trials.tolerance(0.14)) << i;
  }
}

TEST(BoardPose, AFrontalDistantBoardIsAmbiguous) {
  const Camera camera = cameras().front();
  const Rigid3 T = board_in_view(camera, kBoard, 4.0, 0.1, 0.3, 0.2, {640.0, 360.0});
  std::vector<CornerObservation> corners = exact_corners(camera, T, 0.3);
  RandomStream random(3, "noise");
  for (CornerObservation& corner : corners) corner.pixel += 0.3 * Vector2d(random.normal(), random.normal());
  const auto pose = estimate_board_pose(corners, kBoard, camera);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT(pose->ambiguity_ratio, 1.5);
}

TEST(BoardPose, WeighsCornersByTheirCovariance) {
  const Camera camera = cameras().front();
  const Rigid3 T = board_in_view(camera, kBoard, 1.5, 0.6, 0.3, 0.2, {640.0, 360.0});
  std::vector<CornerObservation> corners = exact_corners(camera, T, 0.01);
  corners[3].pixel += Vector2d(5.0, -4.0);
  corners[3].covariance_px2 *= 1e10;
  const auto pose = estimate_board_pose(corners, kBoard, camera);
  ASSERT_TRUE(pose.has_value());
  EXPECT_TRUE(IsPoseNear(T, pose->T_camera_board, 1e-6, 1e-6));
}

TEST(BoardPose, IsAbsentWhereCornersCannotTell) {
  const Camera camera = cameras().front();
  const Rigid3 T = board_in_view(camera, kBoard, 1.5, 0.6, 0.3, 0.2, {640.0, 360.0});
  const std::vector<CornerObservation> corners = exact_corners(camera, T, 0.1);
  EXPECT_FALSE(estimate_board_pose({}, kBoard, camera));
  EXPECT_FALSE(estimate_board_pose({corners.begin(), corners.begin() + 3}, kBoard, camera));
  // A row of four corners lies on a line.
  EXPECT_FALSE(estimate_board_pose({corners.begin(), corners.begin() + 4}, kBoard, camera));
  std::vector<CornerObservation> broken = corners;
  broken[0].pixel.x() = std::nan("");
  EXPECT_FALSE(estimate_board_pose(broken, kBoard, camera));
  broken = corners;
  broken[0].id = 99;
  EXPECT_FALSE(estimate_board_pose(broken, kBoard, camera));
  for (CornerObservation& corner : broken) corner = corners[0];
  EXPECT_FALSE(estimate_board_pose(broken, kBoard, camera));
}

}  // namespace
}  // namespace rigproof
