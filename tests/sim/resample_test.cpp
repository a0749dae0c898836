#include "resample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "depth.h"

namespace rigproof {
namespace {

// RGBA rows from the top.
struct Picture {
  int width, height;
  std::vector<std::uint8_t> pixels;

  Picture(int width_in, int height_in)
      : width(width_in), height(height_in), pixels(static_cast<std::size_t>(width_in * height_in * 4), 255) {}
  void set(int x, int y, int value) {
    for (int c = 0; c < 3; ++c)
      pixels[static_cast<std::size_t>((y * width + x) * 4 + c)] = static_cast<std::uint8_t>(value);
  }
  RgbaView view() const { return {pixels.data(), width * 4, width, height}; }
};

Picture spot(int size, int value) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) picture.set(x, y, x == size / 2 && y == size / 2 ? value : 0);
  return picture;
}

struct Moments {
  double sum = 0.0, mean_x = 0.0, mean_y = 0.0, variance_x = 0.0;
};

Moments moments(const Image8& image) {
  Moments m;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double value = image.at(x, y);
      m.sum += value;
      m.mean_x += x * value;
      m.mean_y += y * value;
      m.variance_x += x * x * value;
    }
  m.mean_x /= m.sum;
  m.mean_y /= m.sum;
  m.variance_x = m.variance_x / m.sum - m.mean_x * m.mean_x;
  return m;
}

TEST(PointSpread, KeepsPlaceAndHasItsWidth) {
  Image8 out;
  for (const double sigma : {0.6, 1.0, 1.7}) {
    PointSpread(sigma).apply(spot(41, 255).view(), &out);
    const Moments m = moments(out);
    EXPECT_DOUBLE_EQ(m.mean_x, 20.0) << sigma;
    EXPECT_DOUBLE_EQ(m.mean_y, 20.0) << sigma;
    // The tails round to nothing in eight bits, which narrows a spot.
    EXPECT_NEAR(std::sqrt(m.variance_x), sigma, 0.16 * sigma) << sigma;
  }
}

TEST(PointSpread, FlatStaysFlatAndZeroCopies) {
  Picture flat(17, 9);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 17; ++x) flat.set(x, y, 137);
  Image8 out;
  for (const double sigma : {0.0, 0.3, 0.6, 2.5}) {
    PointSpread(sigma).apply(flat.view(), &out);
    for (const std::uint8_t value : out.pixels) ASSERT_EQ(value, 137) << sigma;
  }
  PointSpread(0.0).apply(spot(9, 200).view(), &out);
  EXPECT_EQ(out.at(4, 4), 200);
  EXPECT_EQ(out.at(3, 4), 0);
}

// Grey levels rise by eight a reduced pixel: the mean of its columns is half a step of theirs below its end.
void expect_means(int factor, double sigma) {
  AreaReduction reduction(sigma, factor);
  const int margin = reduction.margin_px(), size = 12, step = 8 / factor;
  const int fine = factor * (size + 2 * margin);
  Picture ramp(fine, fine);
  for (int y = 0; y < fine; ++y)
    for (int x = 0; x < fine; ++x) ramp.set(x, y, step * x);
  Image8 out(size + 4, size + 6, 3);
  reduction.apply(ramp.view(), {3, 5, size, size}, &out);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double mean = 8.0 * (x + margin) + 0.5 * (8 - step);
      ASSERT_NEAR(out.at(3 + x, 5 + y, 1), mean, 0.501) << factor << " " << sigma << " " << x;
    }
  EXPECT_EQ(out.at(2, 5), 0);
  EXPECT_EQ(out.at(3 + size, 5), 0);
}

TEST(AreaReduction, AveragesPixelsInPlace) {
  for (const int factor : {2, 4, 8})
    for (const double sigma : {0.0, 0.6, 1.2}) expect_means(factor, sigma);
}

TEST(SampleRow, BlendsLinearlyAndLeavesTheOutsideBlack) {
  Picture ramp(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) ramp.set(x, y, 16 * x + 8 * y);
  const float xs[] = {2.5F, 3.25F, -0.1F, std::nanf(""), 7.5F}, ys[] = {1.0F, 4.5F, 2.0F, 2.0F, 2.0F};
  std::uint8_t out[5 * 4];
  sample_row(ramp.view(), xs, ys, 5, out);
  EXPECT_EQ(out[0], 48);
  EXPECT_EQ(out[4], 52 + 36);
  for (int i = 2; i < 5; ++i) EXPECT_EQ(out[4 * i], 0) << i;
}

// A tilted plane and, from column `edge` on, another one far behind.
std::vector<std::uint32_t> stepped_depth(int size, int edge, const mujoco::DepthLaw& law) {
  std::vector<std::uint32_t> pixels(static_cast<std::size_t>(size * size));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double inverse = (x < edge ? 0.5 : 0.2) + 1e-3 * x + 2e-3 * (size - 1 - y);
      const auto counts = static_cast<std::uint32_t>(std::lround((inverse - law.offset_per_m) / law.slope_per_m));
      pixels[static_cast<std::size_t>(y * size + x)] = (((1U << 24U) - 1U) - counts) << 8U;
    }
  return pixels;
}

TEST(Depth, IsExactOnPlanesUpToTheEdge) {
  const mujoco::DepthLaw law = mujoco::depth_law(0.35, 20.0);
  constexpr int kSize = 20, kEdge = 10;
  const std::vector<std::uint32_t> pixels = stepped_depth(kSize, kEdge, law);
  const WindowDepth source{pixels.data(), kSize, kSize};
  for (const double x : {3.3, 8.4, 9.4, 9.6, 11.7}) {
    for (const double y : {5.0, 7.25, 12.5}) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      float depth = 0.0F;
      sample_depth_row(source, law, &fx, &fy, 1, &depth);
      // Row 0 of a WindowDepth is the bottom row; the image's rows count from the top.
      const double expected = 1.0 / ((x < kEdge - 0.5 ? 0.5 : 0.2) + 1e-3 * x + 2e-3 * y);
      EXPECT_NEAR(static_cast<double>(depth), expected, 2e-5) << x << " " << y;  // steps of the buffer at 5 m
    }
  }
}

TEST(Depth, NothingIsZero) {
  const mujoco::DepthLaw law = mujoco::depth_law(0.35, 20.0);
  const std::vector<std::uint32_t> pixels(36, 0xFFFFFF00U);
  ImageF depth;
  convert_depth({pixels.data(), 6, 6}, law, &depth);
  for (const float value : depth.pixels) EXPECT_EQ(value, 0.0F);
  const float x = 2.2F, y = 40.0F;
  float sampled = 1.0F;
  sample_depth_row({pixels.data(), 6, 6}, law, &x, &x, 1, &sampled);
  EXPECT_EQ(sampled, 0.0F);
  sample_depth_row({pixels.data(), 6, 6}, law, &x, &y, 1, &sampled);
  EXPECT_EQ(sampled, 0.0F);
}

TEST(Depth, ConvertsTheClipPlanes) {
  const mujoco::DepthLaw law = mujoco::depth_law(0.35, 20.0);
  const std::uint32_t at_near = 0;
  ImageF depth;
  convert_depth({&at_near, 1, 1}, law, &depth);
  EXPECT_NEAR(static_cast<double>(depth.at(0, 0)), 0.35, 1e-6);
}

}  // namespace
}  // namespace rigproof
