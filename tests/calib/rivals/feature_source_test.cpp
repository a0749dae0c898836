// Features from SIFT and from a network that is made here, byte by byte.
#include "rigproof/calib/vision/feature_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_text.h"
#include "onnx_bytes.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "room.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

Image8 dots(const std::vector<Eigen::Vector2i>& places, int width, int height) {
  Image8 image(width, height);
  for (const Eigen::Vector2i& place : places) image.at(place.x(), place.y()) = 255;
  return image;
}

TEST(DnnFeatures, FindsWhatTheNetworkLooksFor) {
  const TempFolder folder;
  const auto source = dnn_features(folder.write("tiny.onnx", keypoint_network()));
  // 60 x 42: no multiple of the cells' size.
  std::vector<Eigen::Vector2i> places = {{5, 3}, {30, 9}, {57, 38}, {12, 33}, {47, 18}};
  const ImageFeatures found = source->detect(dots(places, 60, 42));
  ASSERT_EQ(found.pixels.size(), places.size());
  EXPECT_EQ(found.descriptors.rows(), 5);
  EXPECT_EQ(found.descriptors.cols(), kNetworkDescriptors);
  for (const Eigen::Vector2i& place : places) {
    const bool there = std::any_of(found.pixels.begin(), found.pixels.end(),
                                   [&](const Eigen::Vector2d& pixel) { return pixel == place.cast<double>(); });
    EXPECT_TRUE(there) << place.transpose();
  }
  for (Eigen::Index i = 0; i < 5; ++i) EXPECT_NEAR(found.descriptors.row(i).norm(), 1.0F, 1e-5F);
  EXPECT_TRUE(source->detect(Image8(60, 42)).pixels.empty());
}

TEST(DnnFeatures, MatchesAnImageWithItself) {
  const TempFolder folder;
  const auto source = dnn_features(folder.write("tiny.onnx", keypoint_network()));
  const Image8 image = dots({{5, 3}, {30, 9}, {57, 38}, {12, 33}, {47, 18}}, 64, 48);
  const ImageFeatures a = source->detect(image), b = source->detect(image);
  const auto matches = match_features(a, b, 0.9);
  ASSERT_EQ(matches.size(), a.pixels.size());
  for (const auto& [i, j] : matches) EXPECT_EQ(a.pixels[i], b.pixels[j]);
}

TEST(DnnFeatures, SaysWhatIsWrongWithANetwork) {
  const TempFolder folder;
  EXPECT_THAT(error_text([&] { dnn_features(folder / "none.onnx"); }), HasSubstr("none.onnx"));
  const auto garbage = folder.write("garbage.onnx", "this is no network");
  EXPECT_THAT(error_text([&] { dnn_features(garbage); }), HasSubstr("garbage.onnx"));
  const auto other = folder.write("other.onnx", keypoint_network(10));
  EXPECT_THAT(error_text([&] { dnn_features(other); }), HasSubstr("65 channels"));
}

TEST(SiftFeatures, MatchTheSamePlacesOfTwoViews) {
  const Camera camera = Camera::symmetric(480, 360, 300.0);
  const Rigid3 first = mounted(-1.0, 0.0, 0.8, 0.1, 0.3, 0.0);
  const Rigid3 second(first.rotation * so3_exp(Eigen::Vector3d(0.0, 0.05, 0.0)), first.translation);
  const auto source = sift_features();
  const ImageFeatures a = source->detect(draw_room(camera, first)), b = source->detect(draw_room(camera, second));
  const auto matches = match_features(a, b);
  ASSERT_GT(matches.size(), 150U);
  const Eigen::Quaterniond R_second_first = second.rotation.conjugate() * first.rotation;
  std::size_t right = 0;
  for (const auto& [i, j] : matches) {
    Eigen::Vector3d ray;
    Eigen::Vector2d expected;
    if (!camera.unproject(a.pixels[i], &ray) || !camera.project(R_second_first * ray, &expected)) continue;
    right += (expected - b.pixels[j]).norm() < 1.0;
  }
  EXPECT_GT(static_cast<double>(right), 0.9 * static_cast<double>(matches.size()));
  EXPECT_TRUE(match_features(a, ImageFeatures()).empty());
}

// Blobs at known places between the pixels: a shift, however small, would tilt every ray.
TEST(SiftFeatures, LieWhereTheyAreSeen) {
  Image8 image(320, 240, 1, 40);
  std::vector<Eigen::Vector2d> places;
  RandomStream random(1, "blobs");
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      places.emplace_back(30.0 + 43.0 * column + random.uniform(-0.5, 0.5),
                          25.0 + 46.0 * row + random.uniform(-0.5, 0.5));
      const double size = random.uniform(2.0, 5.0);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const double squares = (Eigen::Vector2d(x, y) - places.back()).squaredNorm() / (2.0 * size * size);
          if (squares < 9.0) image.at(x, y) = static_cast<std::uint8_t>(std::lround(40.0 + 180.0 * std::exp(-squares)));
        }
    }
  }
  const ImageFeatures found = sift_features()->detect(image);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const Eigen::Vector2d& place : places)
    for (const Eigen::Vector2d& pixel : found.pixels)
      if ((pixel - place).norm() < 1.0) {
        sum += pixel - place;
        ++count;
      }
  ASSERT_GE(count, 30);
  EXPECT_LT((sum / count).norm(), 0.03) << (sum / count).transpose() << " of " << count;
}

TEST(FeatureSource, GoesByName) {
  const TempFolder folder;
  EXPECT_NE(feature_source_by_name("sift"), nullptr);
  const std::string network = folder.write("tiny.onnx", keypoint_network()).string();
  EXPECT_EQ(feature_source_by_name("onnx:" + network)->detect(dots({{5, 3}}, 60, 42)).pixels.size(), 1U);
  EXPECT_THAT(error_text([&] { feature_source_by_name("surf"); }), HasSubstr("onnx:FILE"));
  EXPECT_THAT(error_text([&] { feature_source_by_name("onnx:"); }), HasSubstr("onnx:FILE"));
}

}  // namespace
}  // namespace rigproof
