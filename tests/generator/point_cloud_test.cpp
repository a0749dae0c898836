// Points lie where their pixels see, and files of clouds are what readers expect.
#include "rigproof/generator/point_cloud.h"

#include <gtest/gtest.h>

#include <cstring>

#include "rigproof/core/pcd.h"

namespace rigproof {
namespace {

TEST(PointCloud, PointsProjectBackToTheirPixels) {
  Camera camera = Camera::symmetric(64, 48, 60.0);
  camera.lens = Lens::kBrownConrady;
  camera.distortion = {-0.05, 0.01, 0.001, -0.001, 0.0};
  const int stride = 3;
  Image16 depth(64, 48);
  std::vector<std::pair<Eigen::Vector2d, double>> expected;
  for (int y = 0; y < 48; y += stride) {
    for (int x = 0; x < 64; x += stride) {
      if ((x + y) % 2 != 0) continue;
      depth.at(x, y) = static_cast<std::uint16_t>(500 + 7 * x + y);
      expected.emplace_back(Eigen::Vector2d(x, y), depth.at(x, y) * 0.001);
    }
  }
  CloudMaker maker(camera, stride);
  const auto& points = maker.points(depth, 0.001);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point(static_cast<double>(points[i][0]), static_cast<double>(points[i][1]),
                                static_cast<double>(points[i][2]));
    Eigen::Vector2d pixel;
    ASSERT_TRUE(camera.project(point, &pixel));
    // Single precision: 6e-8 of 60 pixels, and the undistortion's own accuracy.
    EXPECT_LT((pixel - expected[i].first).norm(), 1e-4);
    EXPECT_NEAR(point.z(), expected[i].second, 1e-6);
  }
}

TEST(PointCloud, PcdHasTheHeaderAndTheBytes) {
  const std::vector<std::array<float, 3>> points = {{1.0F, -2.0F, 3.5F}, {0.25F, 0.5F, 4.0F}};
  const std::string file = encode_pcd(points);
  const std::string mark = "DATA binary\n";
  const std::size_t data = file.find(mark) + mark.size();
  EXPECT_NE(file.find("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"), std::string::npos);
  EXPECT_NE(file.find("POINTS 2\n"), std::string::npos);
  ASSERT_EQ(file.size() - data, 24U);
  EXPECT_EQ(std::memcmp(file.data() + data, points.data(), 24), 0);
}

}  // namespace
}  // namespace rigproof
