// Depth models, each against its formula, over many samples. docs/theory/sensors.md has the formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "effects_of.h"
#include "error_text.h"
#include "rigproof/core/error.h"
#include "sensing/normals.h"

namespace rigproof {
namespace {

constexpr int kWidth = 640, kHeight = 480;
const Image8 kNoColor;

// Of the measurements that are there, against the truth, in metres.
struct Walls {
  double bias_m = 0.0, sigma_m = 0.0, valid_share = 0.0;
};

Image16 sense(const DepthSensing& model, const ImageF& depth_m, std::int64_t frame = 0,
              const Image8& color = kNoColor) {
  SensorModel sensor_model;
  sensor_model.depth = model;
  Image16 counts;
  Sensor(sensor_model, depth_m.width, depth_m.height)
      .sense_depth(depth_m, color, model.stream.unit_m, {0, frame, 0}, &counts);
  return counts;
}

Walls statistics(const Image16& counts, const ImageF& truth_m, double unit_m) {
  double sum = 0.0, squares = 0.0, valid = 0.0;
  for (std::size_t i = 0; i < counts.pixels.size(); ++i) {
    if (counts.pixels[i] == 0) continue;
    const double error = unit_m * counts.pixels[i] - static_cast<double>(truth_m.pixels[i]);
    sum += error;
    squares += error * error;
    ++valid;
  }
  Walls walls;
  walls.bias_m = sum / valid;
  walls.sigma_m = std::sqrt(squares / valid - walls.bias_m * walls.bias_m);
  walls.valid_share = valid / static_cast<double>(counts.pixels.size());
  return walls;
}

// A wall that is a few units oblique, so that rounding falls everywhere between two steps, as it does on real surfaces.
ImageF wall_at(double z_m, double unit_m) {
  ImageF wall(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      wall.at(x, y) = static_cast<float>(z_m + 20.0 * unit_m * (x - kWidth / 2) / kWidth);
  return wall;
}

Walls measure(const DepthSensing& model, double z_m) {
  const ImageF wall = wall_at(z_m, model.stream.unit_m);
  return statistics(sense(model, wall, std::lround(1000.0 * z_m)), wall, model.stream.unit_m);
}

// The goal is 5 %. 640 x 480 / 4^2 independent values give 0.5 % of the deviation; steps of disparity that are about as
// coarse as the unit are rounded to it unevenly.
TEST(SensingDepth, EveryPresetFollowsItsLawWithRounding) {
  for (const char* name : {"d455", "d435", "l515", "ideal"}) {
    const DepthSensing model = depth_sensing_of(load_sensor_device(name));
    for (const double z_m : {0.8, 1.0, 2.0, 4.0}) {
      const Walls walls = measure(model, z_m);
      if (z_m > model.stream.max_m) {
        EXPECT_EQ(walls.valid_share, 0.0) << name << " at " << z_m << " is beyond its range";
        continue;
      }
      EXPECT_EQ(walls.valid_share, 1.0) << name << " at " << z_m;
      const double expected = model.recorded_sigma_m(z_m);
      EXPECT_NEAR(walls.sigma_m / expected, 1.0, 0.03) << name << " at " << z_m;
      EXPECT_GE(expected, model.stream.noise.sigma_m(z_m)) << name;
    }
  }
}

TEST(SensingDepth, RoundingIsPartOfTheLaw) {
  const DepthSensing model = depth_sensing_of(load_sensor_device("d455"));
  // 0.5 m: 0.47 mm by the law; steps of 0.19 mm and units of 1 mm, over sqrt(12), make it 0.56 mm.
  EXPECT_NEAR(model.stream.noise.sigma_m(0.5), 0.000473, 2e-6);
  EXPECT_NEAR(model.recorded_sigma_m(0.5), 0.000556, 3e-6);
  EXPECT_NEAR(measure(model, 0.5).sigma_m / model.recorded_sigma_m(0.5), 1.0, 0.03);
}

// Without noise a wall has one disparity, a multiple of the step.
TEST(SensingDepth, DisparityIsRoundedToItsSteps) {
  DepthSensing model = depth_sensing_of(load_sensor_device("d455"));
  model.noise = false;
  model.stream.unit_m = 0.0001;
  for (const double z_m : {0.8, 1.7, 3.3, 5.1}) {
    const Image16 counts = sense(model, ImageF(8, 8, 1, static_cast<float>(z_m)));
    const double steps = model.focal_baseline_px_m / z_m / model.disparity_step_px;
    const double expected = model.focal_baseline_px_m / (std::round(steps) * model.disparity_step_px);
    EXPECT_NEAR(0.0001 * counts.pixels[0], expected, 0.00006) << z_m;
    model.disparity_step_px = 0.0;
    EXPECT_NEAR(0.0001 * sense(model, ImageF(8, 8, 1, static_cast<float>(z_m))).pixels[0], z_m, 0.0002);
    model.disparity_step_px = 1.0 / 32.0;
  }
}

TEST(SensingDepth, SmoothFieldsAreStandardNormalEverywhereAndSmooth) {
  constexpr int kSide = 64, kFields = 600;
  constexpr double kCell = 16.0;
  std::vector<double> squares(kSide, 0.0);
  double beside = 0.0, far = 0.0;
  for (int field = 0; field < kFields; ++field) {
    const SmoothField smooth(kSide, kSide, kCell, RandomStream(3, "field", field));
    std::vector<float> row(kSide);
    smooth.row(29, row.data());
    for (std::size_t x = 0; x < kSide; ++x) squares[x] += static_cast<double>(row[x]) * static_cast<double>(row[x]);
    beside += static_cast<double>(row[20]) * static_cast<double>(row[21]);
    far += static_cast<double>(row[0]) * static_cast<double>(row[63]);
  }
  // Standard error of a variance from 600 values: 5.8 %; four of them and a half, since 64 are looked at.
  for (const double sum : squares) EXPECT_NEAR(sum / kFields, 1.0, 0.26);
  EXPECT_GT(beside / kFields, 0.8);
  EXPECT_NEAR(far / kFields, 0.0, 0.17);  // four cells apart nothing is shared: standard error 0.041
}

TEST(SensingDepth, BiasFieldIsFixedForADeviceSmoothAndOfItsSize) {
  DepthSensing model = depth_sensing_of(load_sensor_device("d455"));
  model.noise = false;
  model.disparity_step_px = 0.0;
  model.stream.unit_m = 0.0001;
  // 40 pixels of the focal length's 640.
  add_effects(&model, "bias_field: true", "{bias_px: 0.05, bias_cell_deg: 3.576334375}");
  const ImageF wall(kWidth, kHeight, 1, 2.0F);
  const Image16 first = sense(model, wall, 0), second = sense(model, wall, 1);
  EXPECT_EQ(first.pixels, second.pixels);
  // 0.05 px of disparity at 2 m are 4 * 0.05 / 42.3 m. 16 x 12 cells give the deviation to 5 %.
  const double expected = 4.0 * 0.05 / model.focal_baseline_px_m;
  EXPECT_NEAR(statistics(first, wall, 0.0001).sigma_m / expected, 1.0, 0.2);
  int largest_step = 0;
  for (int x = 1; x < kWidth; ++x)
    largest_step = std::max(largest_step, std::abs(first.at(x, 200) - first.at(x - 1, 200)));
  EXPECT_LT(0.0001 * largest_step, 0.15 * expected);
}

TEST(SensingDepth, CoarseNoiseKeepsTheLawAndAddsPatches) {
  SensorDevice device = load_sensor_device("l515");
  DepthSensing model = depth_sensing_of(device);
  const auto block_variance = [&](const DepthSensing& of) {
    // Means of 12 x 12 pixels: fine noise averages out, patches and slow ripples stay.
    double sum = 0.0;
    int blocks = 0;
    for (int frame = 0; frame < 4; ++frame) {
      const Image16 counts = sense(of, ImageF(kWidth, kHeight, 1, 2.0F), frame);
      for (int y = 0; y + 12 <= kHeight; y += 12) {
        for (int x = 0; x + 12 <= kWidth; x += 12, ++blocks) {
          double mean = 0.0;
          for (int v = 0; v < 12; ++v)
            for (int u = 0; u < 12; ++u) mean += of.stream.unit_m * counts.at(x + u, y + v) - 2.0;
          sum += std::pow(mean / 144.0, 2);
        }
      }
    }
    return sum / blocks;
  };
  const double law = std::pow(model.stream.noise.sigma_m(2.0), 2);
  const double fine = block_variance(model) / law;
  EXPECT_NEAR(fine, 4.0 / 144.0, 0.01);  // correlated over 2 x 2 pixels
  // Ripples of 12 pixels average out over a block.
  DeviceDraws draws;
  add_effects(switched(device.depth.effects, kNoDepthEffects, "coarse_noise: true", "ripple_px: 12"), false, &draws,
              &model);
  SensorModel sensor;
  sensor.depth = model;
  const double patchy_share = sensor.labels().at("depth_patchy_share");
  EXPECT_EQ(sensor.labels().count("depth_ripple_share"), 1U);
  EXPECT_NEAR(measure(model, 2.0).sigma_m / model.recorded_sigma_m(2.0), 1.0, 0.05);
  // A patch of 24 px keeps most of its variance in a block of 12.
  EXPECT_GT(block_variance(model) / law, 0.6 * patchy_share);
  EXPECT_LT(block_variance(model) / law, 1.2 * patchy_share);
}

TEST(SensingDepth, RipplesRunAlongTheRowsWithTheirLengthAndShare) {
  DepthSensing model = depth_sensing_of(load_sensor_device("l515"));
  add_effects(&model, "coarse_noise: true", "{ripple_share: 0.5, ripple_px: 16}");
  const Image16 counts = sense(model, ImageF(kWidth, kHeight, 1, 2.0F));
  double power = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    double sine = 0.0, cosine = 0.0;
    for (int x = 0; x < kWidth; ++x) {
      const double value = model.stream.unit_m * counts.at(x, y) - 2.0, angle = 2.0 * M_PI * x / 16.0;
      sine += value * std::sin(angle);
      cosine += value * std::cos(angle);
    }
    power += 2.0 * (sine * sine + cosine * cosine) / (1.0 * kWidth * kWidth);
  }
  // The fine half adds its share of 640 frequencies, a few per cent with its correlation.
  EXPECT_NEAR(power / kHeight / std::pow(model.stream.noise.sigma_m(2.0), 2), 0.5, 0.05);
}

// A near box in front of a wall: the imager on the right does not see the wall left of it.
TEST(SensingDepth, OcclusionShadowHasTheWidthOfItsFormula) {
  constexpr double kFocal = 640.0, kNear = 1.0, kFar = 3.0;
  ImageF depth(kWidth, 4, 1, static_cast<float>(kFar));
  for (int y = 0; y < 4; ++y)
    for (int x = 300; x < 400; ++x) depth.at(x, y) = static_cast<float>(kNear);
  for (const double offset_m : {0.095, -0.095, 0.05, -0.02}) {
    DepthSensing model;
    model.focal_px = kFocal;
    add_effects(&model, "occlusion: true", "imagers_x_m: [" + std::to_string(offset_m) + "]");
    const ImageF seen = scene_of(model, depth);
    const double width = kFocal * std::abs(offset_m) * (1.0 / kNear - 1.0 / kFar);
    int hidden = 0;
    for (int x = 0; x < kWidth; ++x) {
      if (seen.at(x, 2) > 0.0F) continue;
      ++hidden;
      if (offset_m > 0.0)
        EXPECT_TRUE(x < 300 && x >= 300 - static_cast<int>(std::ceil(width))) << x;
      else
        EXPECT_TRUE(x >= 400 && x < 400 + static_cast<int>(std::ceil(width))) << x;
    }
    EXPECT_NEAR(hidden, width, 1.0) << offset_m;
  }
}

TEST(SensingDepth, ObliquePlanesHaveNeitherShadowsNorEdges) {
  // 1/z linear over the image: a floor from 1 to 5 m, and steep across.
  ImageF depth(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      depth.at(x, y) = 1.0F / (0.2F + 0.8F * static_cast<float>(y) / kHeight + 0.3F * static_cast<float>(x) / kWidth);
  DepthSensing model;
  add_effects(&model, "occlusion: true", "imagers_x_m: [0.036, -0.059]");
  EXPECT_EQ(scene_of(model, depth).pixels, depth.pixels);
  add_effects(&model, "edges: true", "edge_step_per_m: 0.02");
  EXPECT_EQ(scene_of(model, depth).pixels, depth.pixels);
}

TEST(SensingDepth, EdgesFrayAndTheirShareOfPixelsFloatsInBetween) {
  constexpr int kEdge = 320;
  ImageF depth(kWidth, kHeight, 1, 3.0F);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kEdge; ++x) depth.at(x, y) = 1.0F;
  DepthSensing model;
  constexpr double kFlyingShare = 0.4;
  add_effects(&model, "edges: true", "{edge_step_per_m: 0.02, edge_jitter_px: 1, flying_share: 0.4}");
  ImageF frayed = scene_of(model, depth);
  int floating = 0, near_at_far_side = 0;
  for (int y = 10; y < kHeight - 10; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float z = frayed.at(x, y);
      if (std::abs(x - kEdge) > 4) {
        ASSERT_EQ(z, depth.at(x, y)) << x;
      }
      if (z > 1.001F && z < 2.999F) ++floating;
      if (x >= kEdge && z == 1.0F) ++near_at_far_side;
    }
  }
  // The zone is six pixels wide: two on either side of the two pixels where 1/z bends. Of the pixels that could float,
  // those whose two partners lie on one side stay on it: all but a quarter, over the six.
  const double share = floating / (6.0 * (kHeight - 20));
  EXPECT_GT(share, 0.15 * kFlyingShare);
  EXPECT_LT(share, 0.4 * kFlyingShare);
  // Lateral jitter of one pixel brings the near side a pixel or two across.
  EXPECT_GT(near_at_far_side, kHeight / 4);
  add_effects(&model, "edges: true", "{edge_step_per_m: 0.02, edge_jitter_px: 0, flying_share: 0}");
  frayed = scene_of(model, depth);
  EXPECT_EQ(frayed.pixels, depth.pixels);
}

TEST(SensingDepth, PlainAndSaturatedBlocksHaveNoDepthBeyondTheProjector) {
  Image8 color(64, 16, 3, 100);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) color.at(x, y, 1) = static_cast<std::uint8_t>(100 + 20 * (x % 2));  // textured
    for (int x = 48; x < 64; ++x) color.at(x, y, 1) = 255;                                           // saturated
  }
  DepthSensing model;
  add_effects(&model, "texture_holes: true", "{min_contrast_levels: 6, projector_reach_m: 2}");
  for (const float z_m : {1.0F, 3.0F}) {
    const ImageF depth = scene_of(model, ImageF(64, 16, 1, z_m), color);
    EXPECT_EQ(depth.at(8, 8), z_m);
    EXPECT_EQ(depth.at(30, 8), z_m < 2.0F ? z_m : 0.0F);
    EXPECT_EQ(depth.at(56, 8), 0.0F);
  }
}

TEST(SensingDepth, DaylightLeavesAShareOfTheTimeOfFlight) {
  DepthSensing model = depth_sensing_of(load_sensor_device("l515"));
  add_effects(&model, "daylight: true", "outdoor_valid_share: 0.1", true);
  double share = 0.0;
  for (int frame = 0; frame < 10; ++frame) {
    const ImageF wall(kWidth, kHeight, 1, 1.5F);
    share += statistics(sense(model, wall, frame), wall, model.stream.unit_m).valid_share / 10.0;
  }
  // About 640 x 480 / (2.4 x 6)^2 x 10 independent patches: standard error 0.3 %, and four of it.
  EXPECT_NEAR(share, 0.1, 0.012);
}

TEST(SensingDepth, MisregistrationShiftsByWholePixels) {
  DepthSensing model = depth_sensing_of(load_sensor_device("ideal"));
  model.noise = false;
  // One of two values for each axis: the shift is drawn, and the label says what came out.
  add_effects(&model, "misregistration_px: {choice: [3, -2]}");
  SensorModel sensor;
  sensor.depth = model;
  const int x_px = static_cast<int>(sensor.labels().at("depth_shift_x_px"));
  const int y_px = static_cast<int>(sensor.labels().at("depth_shift_y_px"));
  ImageF depth(32, 24, 1, 1.0F);
  depth.at(10, 10) = 2.0F;
  const Image16 counts = sense(model, depth);
  EXPECT_EQ(counts.at(10 + x_px, 10 + y_px), 20000);
  EXPECT_EQ(counts.at(10, 10), 10000);
  EXPECT_EQ(counts.at(x_px > 0 ? 1 : 30, 12), 0);  // came from outside
  EXPECT_EQ(counts.at(16, y_px > 0 ? 1 : 22), 0);
}

TEST(SensingDepth, SwitchesAreLabelledAndNothingElse) {
  SensorModel model;
  EXPECT_TRUE(model.labels().empty());
  model.image = ImageSensing{};
  model.depth = depth_sensing_of(load_sensor_device("d455"));
  EXPECT_THAT(model.labels(), testing::UnorderedElementsAre(
                                  testing::Pair("image_noise", 1.0), testing::Pair("full_well_electrons", 6300.0),
                                  testing::Pair("read_noise_electrons", 2.5), testing::Pair("image_gamma", 2.2),
                                  testing::Pair("depth_noise", 1.0), testing::Pair("disparity_step_px", 1.0 / 32.0)));
  add_effects(&*model.depth, "{bias_field: true, occlusion: true, edges: true}", "{bias_px: 0.05, imagers_x_m: [0.1]}");
  model.image = image_sensing("pixel_pattern: true", "pixel_gain_percent: 1");
  EXPECT_THAT(model.labels(),
              testing::IsSupersetOf({testing::Pair("depth_bias_sigma_px", 0.05), testing::Pair("occlusion", 1.0),
                                     testing::Pair("flying_share", 0.3), testing::Pair("pixel_gain_percent", 1.0)}));
}

TEST(SensingDepth, SensorWithoutDepthHasNoNoiseCurve) {
  EXPECT_THAT(error_text([] { depth_sensing_of(load_sensor_device("fisheye")); }), testing::HasSubstr("no depth"));
}

}  // namespace
}  // namespace rigproof
