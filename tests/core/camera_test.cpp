#include "rigproof/core/camera.h"

#include <gtest/gtest.h>

#include <unsupported/Eigen/AutoDiff>

#include "random_values.h"
#include "rigproof/core/lens.h"

namespace Eigen {

// Eigen's automatic derivatives know no arc tangent.
inline AutoDiffScalar<Vector3d> atan(const AutoDiffScalar<Vector3d>& x) {
  return {std::atan(x.value()), x.derivatives() / (1.0 + x.value() * x.value())};
}

}  // namespace Eigen

namespace rigproof {
namespace {

constexpr Lens kLenses[] = {Lens::kPinhole, Lens::kBrownConrady, Lens::kKannalaBrandt};

class EveryLens : public testing::TestWithParam<Lens> {};

using Jet = Eigen::AutoDiffScalar<Eigen::Vector3d>;

// The projection written once more, with automatic derivatives.
Eigen::Matrix<double, 2, 3> automatic_jacobian(const Camera& camera, const Eigen::Vector3d& p) {
  const Jet X(p.x(), 3, 0), Y(p.y(), 3, 1), Z(p.z(), 3, 2);
  const Jet x = X / Z, y = Y / Z;
  Jet xd = x, yd = y;
  if (camera.lens == Lens::kBrownConrady) distort_brown_conrady(camera.distortion.data(), x, y, &xd, &yd);
  if (camera.lens == Lens::kKannalaBrandt) distort_kannala_brandt(camera.distortion.data(), x, y, &xd, &yd);
  Eigen::Matrix<double, 2, 3> J;
  J.row(0) = camera.fx_px * xd.derivatives();
  J.row(1) = camera.fy_px * yd.derivatives();
  return J;
}

Eigen::Vector3d point_in_view(RandomStream& random) {
  const double z = random.uniform(0.3, 6.0);
  return {z * random.uniform(-0.8, 0.8), z * random.uniform(-0.5, 0.5), z};
}

TEST_P(EveryLens, JacobianAgreesWithAutomaticDerivatives) {
  RandomStream random(1, "camera jacobian");
  for (int i = 0; i < 200; ++i) {
    const Camera camera = random_camera(random, GetParam());
    const Eigen::Vector3d p = point_in_view(random);
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J;
    ASSERT_TRUE(camera.project(p, &pixel, &J));
    // Both are exact: only rounding, relative to entries of about fx / z.
    EXPECT_LT((J - automatic_jacobian(camera, p)).norm(), 1e-12 * J.norm());
  }
}

TEST_P(EveryLens, JacobianAgreesWithCentralDifferences) {
  RandomStream random(2, "camera differences");
  for (int i = 0; i < 50; ++i) {
    const Camera camera = random_camera(random, GetParam());
    const Eigen::Vector3d p = point_in_view(random);
    Eigen::Vector2d pixel, before, after;
    Eigen::Matrix<double, 2, 3> J;
    ASSERT_TRUE(camera.project(p, &pixel, &J));
    const double step = 1e-5 * p.z();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(axis);
      ASSERT_TRUE(camera.project(p - d, &before) && camera.project(p + d, &after));
      const Eigen::Vector2d slope = (after - before) / (2.0 * step);
      // Truncation is (step / z)^2 = 1e-10 of the entry, rounding 1e-13 * 1000 px / step.
      EXPECT_LT((slope - J.col(axis)).norm(), 1e-7 * J.norm());
    }
  }
}

TEST_P(EveryLens, JacobianOnTheAxisIsFinite) {
  RandomStream random(3, "camera axis");
  const Camera camera = random_camera(random, GetParam());
  for (const double offset : {0.0, 1e-9, 1e-7, 1e-5}) {
    const Eigen::Vector3d p(offset, -offset, 2.0);
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J;
    ASSERT_TRUE(camera.project(p, &pixel, &J));
    // At the axis each lens is a pinhole; the series is cut at r^2 = 1e-12, tangential terms are below 1e-4 * 0.02.
    EXPECT_NEAR(J(0, 0), camera.fx_px / 2.0, 1e-3);
    EXPECT_NEAR(J(1, 1), camera.fy_px / 2.0, 1e-3);
  }
}

TEST_P(EveryLens, UnprojectInvertsProjectOverTheWholeImage) {
  RandomStream random(4, "camera round trip");
  for (int i = 0; i < 20; ++i) {
    const Camera camera = random_camera(random, GetParam());
    for (double v = 0.0; v < camera.height_px; v += 719.0 / 12.0)
      for (double u = 0.0; u < camera.width_px; u += 1279.0 / 16.0) {
        Eigen::Vector3d ray;
        Eigen::Vector2d pixel;
        ASSERT_TRUE(camera.unproject({u, v}, &ray)) << lens_name(camera.lens) << " " << u << " " << v;
        EXPECT_EQ(ray.z(), 1.0);
        ASSERT_TRUE(camera.project(ray * 2.5, &pixel));
        // unproject() iterates until 1e-14 of a normalised unit; times fx = 1000 px and a little rounding.
        EXPECT_LT((pixel - Eigen::Vector2d(u, v)).norm(), 1e-9);
      }
  }
}

TEST_P(EveryLens, NothingBehindTheCameraProjects) {
  RandomStream random(5, "camera behind");
  const Camera camera = random_camera(random, GetParam());
  Eigen::Vector2d pixel(7.0, 8.0);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, -1), Eigen::Vector3d(1, 1, 0),
                                   Eigen::Vector3d(0, 0, std::nan("")), Eigen::Vector3d(std::nan(""), 0, 1)})
    EXPECT_FALSE(camera.project(p, &pixel)) << p.transpose();
  EXPECT_EQ(pixel, Eigen::Vector2d(7.0, 8.0)) << "outputs must be left alone";
}

INSTANTIATE_TEST_SUITE_P(Camera, EveryLens, testing::ValuesIn(kLenses),
                         [](const auto& test) { return std::string(lens_name(test.param)); });

TEST(Camera, PixelCentresAreIntegers) {
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  EXPECT_EQ(camera.cx_px, 639.5);
  EXPECT_EQ(camera.cy_px, 359.5);
  Eigen::Vector2d pixel;
  // 45 degrees to the right meets the right edge of the last pixel: half a pixel beyond its centre at 1279.
  ASSERT_TRUE(camera.project({1.0, 0.0, 1.0}, &pixel));
  EXPECT_DOUBLE_EQ(pixel.x(), 1279.5);
}

TEST(Camera, ContainsCountsFromOutermostPixelCentres) {
  const Camera camera = Camera::symmetric(640, 480, 500.0);
  EXPECT_TRUE(camera.contains({0.0, 0.0}));
  EXPECT_TRUE(camera.contains({639.0, 479.0}));
  EXPECT_FALSE(camera.contains({639.1, 100.0}));
  EXPECT_FALSE(camera.contains({5.0, 100.0}, 6.0));
  EXPECT_FALSE(camera.contains({std::nan(""), 1.0}));
}

// Strong barrel distortion folds the image back beyond a radius; a point there must not appear inside of the image.
TEST(Camera, PointsBeyondTheLensFieldDoNotProject) {
  Camera camera = Camera::symmetric(1280, 720, 640.0);
  camera.lens = Lens::kBrownConrady;
  camera.distortion = {-0.3, 0.0, 0.0, 0.0, 0.0};
  // d/dr (r - 0.3 r^3) = 0 at r = 1 / sqrt(0.9).
  EXPECT_NEAR(std::tan(camera.max_field_angle()), 1.0 / std::sqrt(0.9), 1e-9);
  Eigen::Vector2d pixel;
  EXPECT_TRUE(camera.project({1.05, 0.0, 1.0}, &pixel));
  EXPECT_FALSE(camera.project({1.06, 0.0, 1.0}, &pixel));
  Eigen::Vector3d ray;
  EXPECT_FALSE(camera.unproject({camera.cx_px + 640.0 * 0.75, camera.cy_px}, &ray)) << "no ray meets this pixel";
}

TEST(Camera, FisheyeSeesToItsFieldAngle) {
  Camera camera = Camera::symmetric(1280, 1280, 400.0);
  camera.lens = Lens::kKannalaBrandt;
  EXPECT_DOUBLE_EQ(camera.max_field_angle(), 0.5 * kPi);
  Eigen::Vector2d pixel;
  const double theta = deg_to_rad(85.0);
  ASSERT_TRUE(camera.project({std::sin(theta), 0.0, std::cos(theta)}, &pixel));
  EXPECT_NEAR(pixel.x() - camera.cx_px, 400.0 * theta, 1e-9);
  Eigen::Vector3d ray;
  EXPECT_FALSE(camera.unproject({camera.cx_px + 400.0 * 1.6, camera.cy_px}, &ray)) << "beyond 90 degrees";
}

}  // namespace
}  // namespace rigproof
