#include "lens_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render_truth.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

TEST(LensMap, IsTheInverseOfProject) {
  for (const WorldCamera& camera : figure_cameras()) {
    const LensMap map(camera.camera);
    double worst = 0.0, x[2], y[2];
    for (double row = -5.0; row < camera.camera.height_px + 5.0; row += 23.17) {
      for (double first = -5.0; first < camera.camera.width_px + 4.0; first += 31.41) {
        map.rays_of_row(row, first, 0.5, 2, x, y);
        Eigen::Vector2d pixel;
        ASSERT_TRUE(camera.camera.project({x[1], y[1], 1.0}, &pixel)) << camera.name;
        worst = std::max(worst, (pixel - Eigen::Vector2d(first + 0.5, row)).norm());
      }
    }
    EXPECT_LT(worst, 3e-4) << camera.name;
  }
}

TEST(LensMap, FollowsALensResidual) {
  for (const WorldCamera& camera : figure_cameras()) {
    const std::optional<LensResidual> field = draw_lens_residual(camera.camera, 0.15, 8.0, RandomStream(2, "field"));
    const LensMap map(camera.camera, field);
    double worst = 0.0, x[2], y[2];
    for (double row = 2.0; row < camera.camera.height_px; row += 23.17) {
      for (double first = 2.0; first < camera.camera.width_px - 4.0; first += 31.41) {
        map.rays_of_row(row, first, 0.5, 2, x, y);
        Eigen::Vector2d pixel;
        ASSERT_TRUE(project(camera.camera, field, {x[1], y[1], 1.0}, &pixel)) << camera.name;
        worst = std::max(worst, (pixel - Eigen::Vector2d(first + 0.5, row)).norm());
      }
    }
    EXPECT_LT(worst, 3e-4) << camera.name;
  }
}

TEST(LensMap, HasNoRaysWhereTheLensHasNone) {
  Camera fisheye = Camera::symmetric(1280, 720, 520.0);  // 141 degrees wide; the corners look 81 degrees away
  fisheye.lens = Lens::kKannalaBrandt;
  const LensMap map(fisheye);
  double x, y;
  map.rays_of_row(0.0, 0.0, 1.0, 1, &x, &y);
  EXPECT_TRUE(std::isnan(x));
  map.rays_of_row(360.0, 0.0, 1.0, 1, &x, &y);
  EXPECT_NEAR(std::atan(std::hypot(x, y)), std::hypot(639.5, 0.5) / 520.0, 1e-6);
}

TEST(LensMap, RefusesHalfASphere) {
  Camera fisheye = Camera::symmetric(1280, 720, 400.0);
  fisheye.lens = Lens::kKannalaBrandt;
  EXPECT_THROW(LensMap{fisheye}, Error);
}

}  // namespace
}  // namespace rigproof
