// Features from SIFT and from a network that is made here, byte by byte.
#include "rigproof/calib/feature_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "error_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "room.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

// ----------------------------------------------------------------------------------- ONNX, as protocol buffers spell
// it

std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80U; value >>= 7U) bytes.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}
std::string number(int field, std::uint64_t value) {
  return varint(static_cast<std::uint64_t>(field) << 3U) + varint(value);
}
std::string bytes(int field, const std::string& value) {
  return varint((static_cast<std::uint64_t>(field) << 3U) | 2U) + varint(value.size()) + value;
}

std::string tensor(const std::string& name, const std::vector<int>& shape, const std::vector<float>& values) {
  std::string text;
  for (const int size : shape) text += number(1, static_cast<std::uint64_t>(size));
  text += number(2, 1);  // float
  text += bytes(8, name);
  std::string raw(values.size() * sizeof(float), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return text + bytes(9, raw);
}

std::string integers(const std::string& name, const std::vector<int>& values) {
  std::string text = bytes(1, name);
  for (const int value : values) text += number(8, static_cast<std::uint64_t>(value));
  return text + number(20, 7);  // a list of integers
}

std::string convolution(const std::string& name) {
  return bytes(1, "image") + bytes(1, name + "_weight") + bytes(1, name + "_bias") + bytes(2, name) + bytes(3, name) +
         bytes(4, "Conv") + bytes(5, integers("kernel_shape", {8, 8})) + bytes(5, integers("strides", {8, 8}));
}

std::string value_info(const std::string& name, const std::vector<int>& shape) {
  std::string dimensions;
  for (const int size : shape) dimensions += bytes(1, number(1, static_cast<std::uint64_t>(size)));
  return bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, dimensions)));
}

constexpr int kDescriptors = 16;

// One layer: channel c of `scores` looks at pixel c of each cell, the last one is "none"; descriptors mix the cell.
std::string network(int score_channels = 65) {
  std::vector<float> score_weights(static_cast<std::size_t>(score_channels) * 64, 0.0F), mix(kDescriptors * 64);
  for (std::size_t c = 0; c < 64 && c < static_cast<std::size_t>(score_channels); ++c)
    score_weights[c * 64 + c] = 12.0F;
  std::vector<float> score_bias(static_cast<std::size_t>(score_channels), 0.0F);
  score_bias.back() = 8.0F;
  RandomStream random(1, "descriptors");
  for (float& weight : mix) weight = static_cast<float>(random.normal());
  std::string graph = bytes(1, convolution("scores")) + bytes(1, convolution("descriptors")) + bytes(2, "tiny");
  graph += bytes(5, tensor("scores_weight", {score_channels, 1, 8, 8}, score_weights));
  graph += bytes(5, tensor("scores_bias", {score_channels}, score_bias));
  graph += bytes(5, tensor("descriptors_weight", {kDescriptors, 1, 8, 8}, mix));
  graph += bytes(5, tensor("descriptors_bias", {kDescriptors}, std::vector<float>(kDescriptors, 0.1F)));
  graph += bytes(11, value_info("image", {1, 1, 32, 32}));
  graph += bytes(12, value_info("scores", {1, score_channels, 4, 4}));
  graph += bytes(12, value_info("descriptors", {1, kDescriptors, 4, 4}));
  return number(1, 7) + bytes(8, number(2, 11)) + bytes(7, graph);
}

Image8 dots(const std::vector<Eigen::Vector2i>& places, int width, int height) {
  Image8 image(width, height);
  for (const Eigen::Vector2i& place : places) image.at(place.x(), place.y()) = 255;
  return image;
}

TEST(DnnFeatures, FindsWhatTheNetworkLooksFor) {
  const TempFolder folder;
  const auto source = dnn_features(folder.write("tiny.onnx", network()));
  // 60 x 42: no multiple of the cells' size.
  std::vector<Eigen::Vector2i> places = {{5, 3}, {30, 9}, {57, 38}, {12, 33}, {47, 18}};
  const ImageFeatures found = source->detect(dots(places, 60, 42));
  ASSERT_EQ(found.pixels.size(), places.size());
  EXPECT_EQ(found.descriptors.rows(), 5);
  EXPECT_EQ(found.descriptors.cols(), kDescriptors);
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
  const auto source = dnn_features(folder.write("tiny.onnx", network()));
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
  const auto other = folder.write("other.onnx", network(10));
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

}  // namespace
}  // namespace rigproof
