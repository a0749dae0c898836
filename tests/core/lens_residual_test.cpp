#include "rigproof/core/lens_residual.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "error_text.h"
#include "random_values.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

Camera wide_camera(Lens lens) {
  Camera camera = Camera::symmetric(1280, 720, 640.0);
  camera.lens = lens;
  if (lens == Lens::kBrownConrady) camera.distortion = {-0.05, 0.01, 0.0005, -0.0003, 0.0};
  if (lens == Lens::kKannalaBrandt) camera.distortion = {0.02, -0.004, 0.001, 0.0, 0.0};
  return camera;
}

std::vector<Eigen::Vector2d> pixels_of(const Camera& camera) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 8; y < camera.height_px; y += 16)
    for (int x = 8; x < camera.width_px; x += 16) pixels.emplace_back(x, y);
  return pixels;
}

TEST(LensResidual, HasItsSizeAndNoSpike) {
  const Camera camera = wide_camera(Lens::kPinhole);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const LensResidual field = draw_lens_residual(camera, 0.07, 8.0, RandomStream(seed, "field"));
    double squares = 0.0, largest = 0.0;
    const std::vector<Eigen::Vector2d> pixels = pixels_of(camera);
    for (const Eigen::Vector2d& pixel : pixels) {
      squares += 0.5 * field.at(pixel).squaredNorm();
      largest = std::max(largest, field.at(pixel).cwiseAbs().maxCoeff());
    }
    // It is sized over a grid of 48 samples across; this one is denser, and 1 % is what a field of 8 cells changes.
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(pixels.size())), 0.07, 0.0007) << seed;
    EXPECT_LT(largest, 5.0 * 0.07) << seed;
  }
}

TEST(LensResidual, IsSmooth) {
  const Camera camera = wide_camera(Lens::kPinhole);
  const LensResidual field = draw_lens_residual(camera, 0.07, 8.0, RandomStream(1, "field"));
  for (double x = -20.0; x < 1300.0; x += 1.0)
    EXPECT_LT((field.at({x + 1.0, 333.0}) - field.at({x, 333.0})).norm(), 0.01) << x;
  EXPECT_EQ(field.at({-1e4, -1e4}), field.at({-2e4, -1e4})) << "beyond the lattice it stays";
}

// Derivatives of the projection by intrinsics and distortion, by central differences of the camera's own model: what a
// calibration would change to follow the field.
Eigen::MatrixXd derivatives(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<double Camera::*> members = {&Camera::fx_px, &Camera::fy_px, &Camera::cx_px, &Camera::cy_px};
  const int coefficients = camera.lens == Lens::kPinhole ? 5 : coefficient_count(camera.lens);
  Eigen::MatrixXd J(2 * static_cast<Eigen::Index>(pixels.size()), 5 + coefficients);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    Eigen::Vector3d ray;
    EXPECT_TRUE(camera.unproject(pixels[i], &ray));
    const auto column = [&](Eigen::Index k, const Camera& low, const Camera& high, const Eigen::Vector3d& turned) {
      Eigen::Vector2d a, b;
      EXPECT_TRUE(low.project(ray, &a) && high.project(turned, &b));
      J.block<2, 1>(2 * static_cast<Eigen::Index>(i), k) = b - a;
    };
    for (std::size_t k = 0; k < members.size(); ++k) {
      Camera high = camera;
      high.*members[k] += 1e-3;
      column(static_cast<Eigen::Index>(k), camera, high, ray);
    }
    column(4, camera, camera, {ray.x() - 1e-5 * ray.y(), ray.y() + 1e-5 * ray.x(), 1.0});
    for (int k = 0; k < coefficients; ++k) {
      Camera low = camera, high = camera;
      if (camera.lens == Lens::kPinhole) low.lens = high.lens = Lens::kBrownConrady;
      high.distortion[static_cast<std::size_t>(k)] += 1e-6;
      column(5 + k, low, high, ray);
    }
  }
  for (Eigen::Index k = 0; k < J.cols(); ++k) J.col(k).normalize();
  return J;
}

// The share of the field that intrinsics, roll and all coefficients of the lens can follow over the image: nothing for
// a pinhole, where the directions that are taken out are those of the model; with a lens's own curvature, little.
TEST(LensResidual, CalibrationDoesNotFollowIt) {
  for (const auto& [lens, most] :
       {std::pair(Lens::kPinhole, 0.01), {Lens::kBrownConrady, 0.05}, {Lens::kKannalaBrandt, 0.05}}) {
    const Camera camera = wide_camera(lens);
    const std::vector<Eigen::Vector2d> pixels = pixels_of(camera);
    const Eigen::MatrixXd J = derivatives(camera, pixels);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const LensResidual field = draw_lens_residual(camera, 0.07, 8.0, RandomStream(seed, "field"));
      Eigen::VectorXd values(J.rows());
      for (std::size_t i = 0; i < pixels.size(); ++i)
        values.segment<2>(2 * static_cast<Eigen::Index>(i)) = field.at(pixels[i]);
      const Eigen::VectorXd followed = J * J.colPivHouseholderQr().solve(values);
      EXPECT_LT(followed.norm() / values.norm(), most) << lens_name(lens) << ", seed " << seed;
    }
  }
}

TEST(LensResidual, CamerasAndSeedsDiffer) {
  const Camera camera = wide_camera(Lens::kPinhole);
  const auto at = [&](std::uint64_t seed, int index) {
    return draw_lens_residual(camera, 0.07, 8.0, RandomStream(seed, "field", -1, index)).at({300.0, 200.0});
  };
  EXPECT_EQ(at(1, 0), at(1, 0));
  EXPECT_NE(at(1, 0), at(1, 1));
  EXPECT_NE(at(1, 0), at(2, 0));
}

TEST(LensResidual, ProjectionAndRayAreInverse) {
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady, Lens::kKannalaBrandt}) {
    const Camera camera = wide_camera(lens);
    const std::optional<LensResidual> field = draw_lens_residual(camera, 0.15, 8.0, RandomStream(3, "field"));
    for (const Eigen::Vector2d& pixel : pixels_of(camera)) {
      Eigen::Vector3d ray;
      Eigen::Vector2d back, modelled;
      ASSERT_TRUE(unproject(camera, field, pixel, &ray));
      ASSERT_TRUE(project(camera, field, ray, &back));
      EXPECT_LT((back - pixel).norm(), 1e-9);
      ASSERT_TRUE(camera.project(ray, &modelled));
      EXPECT_LT((modelled + field->at(modelled) - pixel).norm(), 1e-9);
    }
  }
}

TEST(LensResidual, TooCoarseALatticeIsRefused) {
  const Camera camera = wide_camera(Lens::kPinhole);
  EXPECT_THROW(draw_lens_residual(camera, 0.07, 3.0, RandomStream(0, "field")), Error);
}

}  // namespace
}  // namespace rigproof
