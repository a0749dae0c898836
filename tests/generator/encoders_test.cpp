// What the writers write is what standard readers read, bit by bit.
#include <gtest/gtest.h>

#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/generator/png_encoder.h"
#include "rigproof/generator/point_cloud.h"

namespace rigproof {
namespace {

enum class Content { kFlat, kSmooth, kNoise, kPatches };

// Rows whose differences to the row above are runs of every length, with noise in between.
template <typename Pixel>
Image<Pixel> make_patches(int width, int height, int channels) {
  Image<Pixel> image(width, height, channels);
  RandomStream random(2, "patches");
  const std::size_t row = image.row_length();
  for (std::size_t i = 0; i < image.pixels.size();) {
    const std::size_t run = random.next_u32() % 600, noise = random.next_u32() % 20;
    const auto step = static_cast<Pixel>(random.next_u32() % 3);
    for (std::size_t k = 0; k < run + noise && i < image.pixels.size(); ++k, ++i) {
      const Pixel above = i < row ? Pixel{0} : image.pixels[i - row];
      image.pixels[i] = static_cast<Pixel>(above + (k < run ? step : random.next_u32()));
    }
  }
  return image;
}

template <typename Pixel>
Image<Pixel> make_image(int width, int height, int channels, Content content) {
  if (content == Content::kPatches) return make_patches<Pixel>(width, height, channels);
  Image<Pixel> image(width, height, channels);
  RandomStream random(1, "image");
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint32_t value = content == Content::kFlat     ? 77U
                                : content == Content::kSmooth ? static_cast<std::uint32_t>(i / 3)
                                                              : random.next_u32();
    image.pixels[i] = static_cast<Pixel>(value);
  }
  return image;
}

cv::Mat decode(std::string_view png) {
  const cv::Mat bytes(1, static_cast<int>(png.size()), CV_8U, const_cast<char*>(png.data()));
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

template <typename Pixel>
void expect_same(const Image<Pixel>& image, const cv::Mat& decoded) {
  ASSERT_EQ(decoded.cols, image.width);
  ASSERT_EQ(decoded.rows, image.height);
  ASSERT_EQ(decoded.channels(), image.channels);
  ASSERT_EQ(decoded.elemSize1(), sizeof(Pixel));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        const int opencv_channel = image.channels == 3 ? 2 - c : c;  // OpenCV stores BGR
        ASSERT_EQ(decoded.ptr<Pixel>(y)[x * image.channels + opencv_channel], image.at(x, y, c)) << x << ' ' << y;
      }
    }
  }
}

TEST(PngEncoder, StandardReaderGetsTheSamePixels) {
  for (const int level : {0, 1, 2, 3}) {
    PngEncoder encoder(level);  // one for all: what an image leaves behind must not reach the next
    for (const Content content : {Content::kNoise, Content::kFlat, Content::kSmooth, Content::kPatches}) {
      for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {641, 479}, {1280, 720}, {70000, 2}}) {
        SCOPED_TRACE(testing::Message() << width << "x" << height << " level " << level);
        expect_same(make_image<std::uint8_t>(width, height, 3, content),
                    decode(encoder.encode(make_image<std::uint8_t>(width, height, 3, content))));
        expect_same(make_image<std::uint8_t>(width, height, 1, content),
                    decode(encoder.encode(make_image<std::uint8_t>(width, height, 1, content))));
        expect_same(make_image<std::uint16_t>(width, height, 1, content),
                    decode(encoder.encode(make_image<std::uint16_t>(width, height, 1, content))));
      }
    }
  }
}

TEST(PngEncoder, SameImageGivesSameBytesWhateverCameBefore) {
  PngEncoder fresh, used;
  const Image8 image = make_image<std::uint8_t>(320, 200, 3, Content::kSmooth);
  used.encode(make_image<std::uint8_t>(1280, 720, 3, Content::kNoise));
  used.encode(make_image<std::uint16_t>(64, 64, 1, Content::kNoise));
  EXPECT_EQ(std::string(fresh.encode(image)), std::string(used.encode(image)));
}

TEST(PngEncoder, RefusesWhatPngCannotHold) {
  PngEncoder encoder;
  EXPECT_THROW(encoder.encode(Image8()), Error);
  EXPECT_THROW(encoder.encode(Image8(4, 4, 2)), Error);
  EXPECT_THROW(encoder.encode(Image16(4, 4, 3)), Error);
  EXPECT_THROW(PngEncoder(4), Error);
}

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
