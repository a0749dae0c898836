// The smooth field that no distortion model follows: it moves nothing that a lens or a pose has, and is as large as
// said.
#include "rigproof/calib/estimate/lens_field.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

namespace rigproof::ml {
namespace {

Camera fisheye() {
  Camera camera = Camera::symmetric(1280, 800, 520.0);
  camera.lens = Lens::kKannalaBrandt;
  camera.distortion = {0.02, -0.01, 0.002, 0.0, 0.0};
  return camera;
}

Camera bent() {
  Camera camera = Camera::symmetric(1280, 720, 640.0);
  camera.lens = Lens::kBrownConrady;
  camera.distortion = {-0.05, 0.03, 0.001, -0.0005, 0.0};
  return camera;
}

constexpr int kAcross = 40, kDown = 25;

// Displacements over the image: of two rows a point, a column a coefficient, and of the points with a ray alone.
struct OverImage {
  Eigen::MatrixXd field, of_lens;
};
OverImage over_image(const Camera& camera) {
  const LensField field(camera);
  const Lenses lenses(camera);
  OverImage all;
  all.field.resize(2 * kAcross * kDown, field.size());
  all.of_lens.resize(all.field.rows(), 8);
  Eigen::Index rows = 0;
  for (int i = 0; i < kAcross * kDown; ++i) {
    const Eigen::Vector2d pixel((i % kAcross + 0.5) / kAcross * camera.width_px - 0.5,
                                (i / kAcross + 0.5) / kDown * camera.height_px - 0.5);
    Eigen::Vector3d ray;
    if (!camera.unproject(pixel, &ray)) continue;
    all.field.middleRows<2>(rows) = field.at(pixel);
    for (int k = 0; k < 8; ++k) {  // by differences: of the lens, then of a turn of the camera
      constexpr double kStep = 1e-6;
      Eigen::Vector2d moved;
      if (k < 5)
        EXPECT_TRUE(lenses.changed(kStep * LensChange::Unit(k)).project(ray, &moved));
      else
        EXPECT_TRUE(camera.project(so3_exp(kStep * Eigen::Vector3d::Unit(k - 5)) * ray, &moved));
      all.of_lens.block<2, 1>(rows, k) = (moved - pixel) / kStep;
    }
    rows += 2;
  }
  all.field.conservativeResize(rows, Eigen::NoChange);
  all.of_lens.conservativeResize(rows, Eigen::NoChange);
  return all;
}

class EveryLensField : public testing::TestWithParam<Camera> {};

TEST_P(EveryLensField, HoldsNothingThatALensOrATurnMakes) {
  const OverImage all = over_image(GetParam());
  ASSERT_GT(all.field.cols(), 15);
  for (int k = 0; k < 8; ++k)
    for (Eigen::Index i = 0; i < all.field.cols(); ++i)
      EXPECT_LT(std::abs(all.of_lens.col(k).normalized().dot(all.field.col(i).normalized())), 0.05) << k << " " << i;
}

TEST_P(EveryLensField, HasARootMeanSquareOfOnePixel) {
  const OverImage all = over_image(GetParam());
  EXPECT_NEAR(all.field.rowwise().squaredNorm().mean(), 1.0, 0.06);
}

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLensField,
                         testing::Values(Camera::symmetric(1280, 720, 640.0), bent(), fisheye()),
                         [](const auto& test) { return std::string(lens_name(test.param.lens)); });

}  // namespace
}  // namespace rigproof::ml
