// Image formation against its formulas, over many samples. docs/theory/sensors.md has the formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "effects_of.h"

namespace rigproof {
namespace {

constexpr int kWidth = 320, kHeight = 240;

Image8 sense(const ImageSensing& model, Image8 image, std::int64_t frame = 0) {
  SensorModel sensor_model;
  sensor_model.image = model;
  Sensor(sensor_model, image.width, image.height).sense_color({0, frame, 0}, &image);
  return image;
}

// A model that takes the whole chain, with one effect that changes nothing to speak of.
ImageSensing whole_chain() {
  return image_sensing("pixel_pattern: true", "{dark_offset_electrons: 0, pixel_gain_percent: 1e-7}");
}

double electrons_of(const ImageSensing& model, int level) {
  return model.full_well_electrons * std::pow(level / 255.0, model.gamma);
}

struct Light {
  double mean = 0.0, variance = 0.0;  ///< electrons
};

Light light_of(const ImageSensing& model, const Image8& image) {
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t level : image.pixels) {
    const double electrons = electrons_of(model, level);
    sum += electrons;
    squares += electrons * electrons;
  }
  const double count = static_cast<double>(image.pixels.size());
  return {sum / count, squares / count - sum / count * (sum / count)};
}

// Variance that the rounding to 8 bits adds, in electrons squared.
double rounding_variance(const ImageSensing& model, double level) {
  const double slope = model.gamma / 255.0 * model.full_well_electrons * std::pow(level / 255.0, model.gamma - 1.0);
  return slope * slope / 12.0;
}

// The photon transfer curve: variance = mean + read noise^2, linear within 2 %. 230,400 samples give the variance to
// 0.3 %; ten random bits lack 0.3 % of it in the tails; the rest is what gamma bends.
TEST(SensingImage, PhotonTransferCurveIsLinear) {
  for (const ImageSensing& model : {ImageSensing{}, whole_chain()}) {
    double xx = 0.0, xy = 0.0, x = 0.0, y = 0.0, n = 0.0;
    for (int level = 40; level <= 240; level += 20) {
      const Light light =
          light_of(model, sense(model, Image8(kWidth, kHeight, 3, static_cast<std::uint8_t>(level)), level));
      const double variance = light.variance - rounding_variance(model, level);
      const double expected = electrons_of(model, level) + std::pow(model.read_noise_electrons, 2);
      EXPECT_NEAR(variance / expected, 1.0, 0.02) << "level " << level;
      EXPECT_NEAR(light.mean / electrons_of(model, level), 1.0, 0.005) << "level " << level;
      xx += light.mean * light.mean;
      xy += light.mean * variance;
      x += light.mean;
      y += variance;
      ++n;
    }
    // One electron of light is one of variance: that is how a camera's gain is measured.
    EXPECT_NEAR((n * xy - x * y) / (n * xx - x * x), 1.0, 0.02);
  }
}

// The chain in electrons and the quick table are one model: the same draws, and levels that differ by rounding at most.
TEST(SensingImage, WholeChainAgreesWithTheTable) {
  Image8 image(kWidth, kHeight, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i % 256);
  const Image8 quick = sense(ImageSensing{}, image), whole = sense(whole_chain(), image);
  int differ = 0, largest = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const int difference = std::abs(quick.pixels[i] - whole.pixels[i]);
    differ += difference != 0;
    largest = std::max(largest, difference);
  }
  EXPECT_LE(largest, 2);
  EXPECT_LT(differ, 0.1 * static_cast<double>(image.pixels.size()));
}

TEST(SensingImage, WithoutNoiseTheChainLeavesLevelsAsTheyAre) {
  ImageSensing model;
  model.noise = false;
  Image8 image(256, 1, 3);
  for (int x = 0; x < 256; ++x)
    for (int c = 0; c < 3; ++c) image.at(x, 0, c) = static_cast<std::uint8_t>(x);
  EXPECT_EQ(sense(model, image).pixels, image.pixels);
}

// Mean over frames leaves the fixed pattern: DSNU in the dark, PRNU in bright light.
TEST(SensingImage, FixedPatternHasItsSizeAndIsTheSameInEveryFrame) {
  ImageSensing model = image_sensing("pixel_pattern: true", "{dark_offset_electrons: 30, pixel_gain_percent: 2}");
  model.noise = false;
  for (const int level : {60, 200}) {
    const Image8 flat(kWidth, kHeight, 3, static_cast<std::uint8_t>(level));
    const Image8 first = sense(model, flat, 0), second = sense(model, flat, 1);
    EXPECT_EQ(first.pixels, second.pixels);
    const double electrons = electrons_of(model, level);
    const double expected = 30.0 * 30.0 + std::pow(0.02 * electrons, 2);
    EXPECT_NEAR((light_of(model, first).variance - rounding_variance(model, level)) / expected, 1.0, 0.03) << level;
  }
}

TEST(SensingImage, DevicesHaveTheirOwnPattern) {
  SensorModel model;
  model.image = image_sensing("pixel_pattern: true", "{dark_offset_electrons: 0, pixel_gain_percent: 5}");
  model.image->noise = false;
  Image8 a(64, 64, 3, 150), b = a;
  Sensor(model, 64, 64, {0, -1, 0}).sense_color({0, 0, 0}, &a);
  Sensor(model, 64, 64, {0, -1, 1}).sense_color({0, 0, 0}, &b);
  EXPECT_NE(a.pixels, b.pixels);
}

TEST(SensingImage, VignettingReachesItsValueInTheCorner) {
  ImageSensing model = image_sensing("vignetting: true", "corner_light_percent: 50");
  model.noise = false;
  const Image8 image = sense(model, Image8(kWidth + 1, kHeight + 1, 3, 200));
  const double centre = electrons_of(model, image.at(kWidth / 2, kHeight / 2));
  EXPECT_EQ(image.at(kWidth / 2, kHeight / 2), 200);
  // 8 bits at level 146 are 1.5 % of the light.
  EXPECT_NEAR(electrons_of(model, image.at(0, 0)) / centre, 0.5, 0.01);
  EXPECT_NEAR(electrons_of(model, image.at(kWidth, kHeight)) / centre, 0.5, 0.01);
  // Halfway: 1 / (1 + (sqrt 2 - 1) / 4)^2.
  EXPECT_NEAR(electrons_of(model, image.at(kWidth / 4, kHeight / 4)) / centre, 0.821, 0.015);
}

TEST(SensingImage, ExposureScalesLightAndItsNoiseFollows) {
  const ImageSensing model = image_sensing("exposure: 0.25");
  const Light light = light_of(model, sense(model, Image8(kWidth, kHeight, 3, 200)));
  const double expected = 0.25 * electrons_of(model, 200);
  EXPECT_NEAR(light.mean / expected, 1.0, 0.005);
  const double level = 255.0 * std::pow(expected / model.full_well_electrons, 1.0 / model.gamma);
  EXPECT_NEAR((light.variance - rounding_variance(model, level)) / (expected + 6.25), 1.0, 0.02);
}

TEST(SensingImage, ExposureJitterDiffersFromFrameToFrame) {
  const ImageSensing model = image_sensing("exposure_jitter_percent: 5");
  const Image8 flat(32, 32, 3, 128);
  double sum = 0.0, squares = 0.0;
  constexpr int kFrames = 300;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double ratio = light_of(model, sense(model, flat, frame)).mean / electrons_of(model, 128);
    sum += ratio;
    squares += ratio * ratio;
  }
  const double mean = sum / kFrames;
  EXPECT_NEAR(mean, 1.0, 0.012);  // standard error 0.3 %
  // Standard error of the deviation: 4.1 % of it.
  EXPECT_NEAR(std::sqrt(squares / kFrames - mean * mean) / 0.05, 1.0, 0.17);
}

// A dark-to-bright edge blurred in linear light: the 16 and 84 % points are one sigma from the edge.
TEST(SensingImage, DefocusBlursLightWithItsSigma) {
  ImageF image(64, 8, 3);
  for (int y = 0; y < 8; ++y)
    for (int x = 32; x < 64; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = 1.0F;
  const ImageSensing defocused = image_sensing("defocus_sigma_px: 2");
  (*defocused.effects.begin())->change_image(&image);
  for (int c = 0; c < 3; ++c) {
    // The edge lies at 31.5; a step blurred by a sampled Gaussian is its distribution at whole pixels.
    for (const int x : {28, 30, 31, 32, 34, 36})
      EXPECT_NEAR(static_cast<double>(image.at(x, 4, c)), 0.5 * std::erfc(-(x - 31.5) / (2.0 * std::sqrt(2.0))), 0.004);
    EXPECT_NEAR(static_cast<double>(image.at(5, 4, c)), 0.0, 1e-6);
    EXPECT_NEAR(static_cast<double>(image.at(60, 0, c)), 1.0, 1e-5);
  }
}

const ImageEffect& only_effect(const ImageSensing& model) { return **model.effects.begin(); }

// Bayer's pattern keeps what all pixels see alike, in each colour by itself: red and blue stay where they are.
TEST(SensingImage, DemosaicingKeepsEvenColours) {
  const ImageSensing model = image_sensing("demosaicing: true");
  Image8 image(40, 30, 3);
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    image.pixels[i] = 200;
    image.pixels[i + 1] = 120;
    image.pixels[i + 2] = 40;
  }
  const Image8 even = image;
  only_effect(model).change_levels(&image);
  EXPECT_EQ(image.pixels, even.pixels);
}

// A step of grey in the second of two columns of one colour: what a pixel sees itself stays, the rest is a guess
// between its neighbours, and no level lies beyond theirs.
TEST(SensingImage, DemosaicingGuessesBesideEdgesAlone) {
  const ImageSensing model = image_sensing("demosaicing: true");
  Image8 image(40, 30, 3, 40);
  for (int y = 0; y < image.height; ++y)
    for (int x = 20; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = 210;
  const Image8 sharp = image;
  only_effect(model).change_levels(&image);
  int changed = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int own = (x & 1) + (y & 1);
      const bool at_rim = x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height;
      if (!at_rim) {
        EXPECT_EQ(image.at(x, y, own), sharp.at(x, y, own)) << x << " " << y;
      }
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(image.at(x, y, c), 40);
        EXPECT_LE(image.at(x, y, c), 210);
        if (image.at(x, y, c) == sharp.at(x, y, c)) continue;
        ++changed;
        EXPECT_LE(std::abs(x - 19.5), 2.0) << "a guess reaches two pixels";
      }
    }
  }
  EXPECT_GT(changed, 20);
}

// Unsharp masking of a step: overshoot of amount times what the blur takes, away from it nothing.
TEST(SensingImage, SharpeningOvershootsByItsAmount) {
  const ImageSensing model = image_sensing("sharpening: true", "{sharpening_amount: 0.5, sharpening_sigma_px: 1}");
  Image8 image(64, 16, 3, 80);
  for (int y = 0; y < image.height; ++y)
    for (int x = 32; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = 160;
  only_effect(model).change_levels(&image);
  for (const int x : {29, 30, 31, 32, 33, 34}) {
    const double step = x < 32 ? 80.0 : 160.0;
    const double blurred = 80.0 + 80.0 * 0.5 * std::erfc(-(x - 31.5) / std::sqrt(2.0));
    // Of the sampled Gaussian, and of rounding twice.
    EXPECT_NEAR(static_cast<double>(image.at(x, 8, 1)), step + 0.5 * (step - blurred), 1.5) << x;
  }
  EXPECT_EQ(image.at(5, 8, 0), 80);
  EXPECT_EQ(image.at(60, 8, 2), 160);
}

// After the noise, as a camera's processor has it: one frame's noise is sharpened, too.
TEST(SensingImage, ProcessingComesAfterNoise) {
  const Image8 flat(kWidth, kHeight, 3, 128);
  const double plain = light_of(ImageSensing{}, sense(ImageSensing{}, flat)).variance;
  const ImageSensing sharpened = image_sensing("sharpening: true"), guessed = image_sensing("demosaicing: true");
  // What is added is of the three colours' mean, a third of whose noise any colour shares.
  EXPECT_GT(light_of(sharpened, sense(sharpened, flat)).variance, 1.1 * plain);
  EXPECT_LT(light_of(guessed, sense(guessed, flat)).variance, 0.9 * plain);
}

}  // namespace
}  // namespace rigproof
