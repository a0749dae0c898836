// Realised noise against the formulas of docs/theory/sensors.md, over many samples.
#include "rigproof/generator/sensors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/error.h"
#include "sensing/normals.h"

namespace rigproof {
namespace {

struct Moments {
  double mean, deviation;
};

template <typename Values, typename Map>
Moments moments_of(const Values& values, const Map& map) {
  double sum = 0.0, squares = 0.0;
  for (const auto value : values) {
    sum += map(value);
    squares += map(value) * map(value);
  }
  const double count = static_cast<double>(values.size());
  return {sum / count, std::sqrt(squares / count - sum / count * (sum / count))};
}

SensorModel realistic() {
  SensorModel model;
  model.image = ImageSensing{};
  model.depth = DepthSensing{};
  model.depth->stream.noise.correlation_px = 4.0;
  return model;
}

Sensor sensor_of(const SensorModel& model, int width = 640, int height = 480) { return Sensor(model, width, height); }

// What the imagers see where texture does not matter.
const Image8 kNoColor;

TEST(Sensors, QuantilesAreThoseOfTheNormalDistribution) {
  const std::vector<float> q = normal_quantiles(10);
  const Moments moments = moments_of(q, [](float v) { return static_cast<double>(v); });
  EXPECT_NEAR(moments.mean, 0.0, 1e-9);
  EXPECT_NEAR(moments.deviation, 1.0, 2e-3);  // what the cut-off tails lack
  // P(x < 1) = 0.841345: quantile number 0.841345 * 1024 - 0.5 = 861.04.
  EXPECT_NEAR(static_cast<double>(q[861]), 1.0, 1e-3);
}

// In linear light the variance is (electrons + read noise^2) / full well^2: the photon transfer curve.
TEST(Sensors, ImageNoiseFollowsThePhotonTransferCurve) {
  const SensorModel model = realistic();
  const Sensor sensor = sensor_of(model);
  const ImageSensing& noise = *model.image;
  for (const int level : {40, 90, 128, 180, 220}) {
    Image8 image(400, 300, 3, static_cast<std::uint8_t>(level));
    sensor.sense_color({0, level, 0}, &image);
    const auto linear = [&](std::uint8_t v) { return std::pow(v / 255.0, noise.gamma); };
    const double light = linear(static_cast<std::uint8_t>(level));
    const Moments moments = moments_of(image.pixels, linear);
    const double slope = noise.gamma / 255.0 * std::pow(level / 255.0, noise.gamma - 1.0);
    const double shot = (noise.full_well_electrons * light + std::pow(noise.read_noise_electrons, 2)) /
                        std::pow(noise.full_well_electrons, 2);
    const double rounding = slope * slope / 12.0;  // 8 bits after gamma
    // 360,000 samples give 0.12 % of the deviation; the ten random bits cost 0.2 %, the curvature of gamma the rest.
    EXPECT_NEAR(moments.deviation / std::sqrt(shot + rounding), 1.0, 0.02) << "level " << level;
    EXPECT_NEAR(moments.mean / light, 1.0, 0.005) << "level " << level;
  }
}

TEST(Sensors, ImageNoiseIsIndependentBetweenPixelsAndColors) {
  const Sensor sensor = sensor_of(realistic());
  Image8 image(300, 300, 3, 128);
  sensor.sense_color({0, 0, 0}, &image);
  double neighbour = 0.0, color = 0.0, square = 0.0;
  for (int y = 1; y < 300; ++y) {
    for (int x = 1; x < 300; ++x) {
      const double here = image.at(x, y) - 128.0;
      neighbour += here * (image.at(x - 1, y) - 128.0) + here * (image.at(x, y - 1) - 128.0);
      color += here * (image.at(x, y, 1) - 128.0);
      square += here * here;
    }
  }
  // Standard error 1 / 300; four of them, the first sum has two terms.
  EXPECT_NEAR(neighbour / square, 0.0, 0.02);
  EXPECT_NEAR(color / square, 0.0, 0.0135);
}

TEST(Sensors, CorrelatedNormalsHaveUnitVarianceAndTheWindowsCorrelation) {
  constexpr int kSide = 4, kSize = 512;
  CorrelatedNormals normals(kSize, kSide, RandomStream(2, "depth noise"));
  std::vector<float> field;
  for (int y = 0; y < kSize; ++y) {
    const float* row = normals.next_row();
    field.insert(field.end(), row, row + kSize);
  }
  const auto at = [&](int x, int y) { return static_cast<double>(field[static_cast<std::size_t>(y * kSize + x)]); };
  for (int shift = 0; shift <= kSide + 1; ++shift) {
    double along_x = 0.0, along_y = 0.0;
    for (int y = 0; y + shift < kSize; ++y) {
      for (int x = 0; x + shift < kSize; ++x) {
        along_x += at(x, y) * at(x + shift, y);
        along_y += at(x, y) * at(x, y + shift);
      }
    }
    const double count = std::pow(kSize - shift, 2);
    // The correlation of a moving average is a triangle. 512^2 / 4^2 independent values: standard error 0.011 at
    // shift 0 (times sqrt 2), four of them.
    const double expected = std::max(0.0, 1.0 - static_cast<double>(shift) / kSide);
    EXPECT_NEAR(along_x / count, expected, 0.045) << shift;
    EXPECT_NEAR(along_y / count, expected, 0.045) << shift;
  }
}

Image16 flat_depth(const Sensor& sensor, float z_m, double unit_m) {
  Image16 counts;
  sensor.sense_depth(ImageF(640, 480, 1, z_m), kNoColor, unit_m, {0, std::lround(100.0F * z_m), 0}, &counts);
  return counts;
}

TEST(Sensors, StereoDepthFollowsItsLawWithRounding) {
  const SensorModel model = realistic();
  const Sensor sensor = sensor_of(model);
  const DepthSensing& depth = *model.depth;
  const double sigma_px = depth.focal_baseline_px_m * depth.stream.noise.inverse_depth_sigma_per_m;
  const double disparity_m = depth.focal_baseline_px_m;
  for (const float z_m : {0.8F, 1.0F, 2.0F, 4.0F}) {
    const double z = static_cast<double>(z_m);
    const Moments moments =
        moments_of(flat_depth(sensor, z_m, 0.001).pixels, [](std::uint16_t count) { return 0.001 * count; });
    const double per_px = z * z / disparity_m;
    const double disparity_px = std::hypot(sigma_px, 1.0 / 32.0 / std::sqrt(12.0));
    const double sigma = std::hypot(per_px * disparity_px, 0.001 / std::sqrt(12.0));
    // 640 x 480 / 16 independent values: 0.5 % of the deviation; the target is 5 %.
    EXPECT_NEAR(moments.deviation / sigma, 1.0, 0.03) << z;
    // Noise in disparity makes depth too large by sigma^2 / z in the mean. Rounding disparity steps that are about as
    // coarse as the unit to that unit leaves up to a quarter of it.
    const double standard_error = sigma / std::sqrt(640.0 * 480.0 / 16.0);
    EXPECT_NEAR(moments.mean, z + sigma * sigma / z, 4.0 * standard_error + 0.00025) << z;
  }
}

TEST(Sensors, TimeOfFlightDepthFollowsItsLaw) {
  SensorModel model = realistic();
  DepthStream& stream = model.depth->stream;
  stream.noise.law = DepthNoise::Law::kTimeOfFlight;
  stream.noise.constant_m = 0.000875;
  stream.noise.proportional = 0.001625;
  stream.unit_m = 0.00025;
  stream.max_m = 9.0;
  const Sensor sensor = sensor_of(model);
  for (const float z_m : {1.0F, 3.0F, 8.0F}) {
    const double sigma = std::hypot(0.000875 + 0.001625 * static_cast<double>(z_m), 0.00025 / std::sqrt(12.0));
    const Moments moments =
        moments_of(flat_depth(sensor, z_m, 0.00025).pixels, [](std::uint16_t count) { return 0.00025 * count; });
    EXPECT_NEAR(moments.deviation / sigma, 1.0, 0.03) << z_m;  // as above
  }
}

TEST(Sensors, DepthOutsideOfTheRangeIsNoMeasurement) {
  SensorModel model = realistic();
  const Sensor sensor = sensor_of(model);
  for (const float z_m : {0.0F, 0.2F, 7.0F, 1e-6F, 1e6F}) {
    for (const std::uint16_t count : flat_depth(sensor, z_m, 0.001).pixels) ASSERT_EQ(count, 0) << z_m;
  }
}

TEST(Sensors, WithoutNoiseDepthIsRoundedToTheUnitAndScaled) {
  SensorModel model;
  model.depth_scale = 1.01;
  Image16 counts;
  ImageF depth(4, 1);
  depth.pixels = {0.0F, 1.0F, 2.0004F, 100.0F};
  Sensor(SensorModel{}, 4, 1).sense_depth(depth, kNoColor, 0.001, {}, &counts);
  EXPECT_EQ(counts.pixels, (std::vector<std::uint16_t>{0, 1000, 2000, 0}));  // 100 m do not fit into 16 bits
  Sensor(model, 4, 1).sense_depth(depth, kNoColor, 0.001, {}, &counts);
  EXPECT_EQ(counts.pixels, (std::vector<std::uint16_t>{0, 1010, 2020, 0}));
}

TEST(Sensors, SameStreamSameNoise) {
  const Sensor sensor = sensor_of(realistic());
  Image8 a(64, 48, 3, 100), b = a, c = a;
  sensor.sense_color({1, 7, 2}, &a);
  sensor.sense_color({1, 7, 2}, &b);
  sensor.sense_color({1, 7, 1}, &c);
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_NE(a.pixels, c.pixels);
}

}  // namespace
}  // namespace rigproof
