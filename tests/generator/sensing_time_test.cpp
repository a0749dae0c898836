// Clocks, dropped frames and told intrinsics.
#include <gtest/gtest.h>

#include <cmath>

#include "effects_of.h"
#include "sensing/resolve.h"

namespace rigproof {
namespace {

constexpr int kStops = 400;

struct Data {
  Recording recording;
  Truth truth;
};

// Two cameras, a stop every two seconds, odometry at 20 Hz.
Data sample_data() {
  Data data;
  for (const char* name : {"left", "right"}) {
    data.truth.cameras.emplace_back().name = name;
    std::vector<CameraFrame>& frames = data.recording.frames.emplace_back();
    for (int i = 0; i < kStops; ++i) {
      CameraFrame frame;
      frame.color_file = std::string(name) + "/color/" + std::to_string(i) + ".png";
      frame.stamp_s = 2.0 * i;
      frames.push_back(frame);
    }
  }
  for (int i = 0; i < 40 * kStops; ++i) data.recording.odometry.push_back({0.05 * i, 0.1 * i, 0.0, 0.0});
  return data;
}

Data disturbed(const TimeSensingConfig& config) {
  Data data = sample_data();
  disturb_time(config, 5, &data.recording, &data.truth);
  return data;
}

TEST(SensingTime, NothingIsDisturbedUnlessAskedFor) {
  const Data data = disturbed({}), clean = sample_data();
  for (std::size_t camera = 0; camera < 2; ++camera) {
    ASSERT_EQ(data.recording.frames[camera].size(), clean.recording.frames[camera].size());
    for (int i = 0; i < kStops; ++i)
      EXPECT_EQ(data.recording.frames[camera][static_cast<std::size_t>(i)].stamp_s, 2.0 * i);
    EXPECT_TRUE(data.truth.cameras[camera].sensing.empty());
  }
  EXPECT_EQ(data.recording.odometry.back().stamp_s, clean.recording.odometry.back().stamp_s);
  EXPECT_TRUE(data.truth.drawn.empty());
}

TEST(SensingTime, OffsetsAreOneForACameraAndToldInTheTruth) {
  TimeSensingConfig config;
  config.clock_offset_ms = Distribution::Kind(Distribution::Uniform{-30.0, 30.0});
  config.camera_delay_ms = 15.0;
  const Data data = disturbed(config);
  double first = 0.0;
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const double offset = data.truth.cameras[camera].sensing.at("clock_offset_s");
    EXPECT_LE(std::abs(offset), 0.030);
    EXPECT_EQ(data.truth.cameras[camera].sensing.at("camera_delay_s"), 0.015);
    for (int i = 0; i < kStops; ++i)
      EXPECT_NEAR(data.recording.frames[camera][static_cast<std::size_t>(i)].stamp_s, 2.0 * i + offset + 0.015, 1e-12);
    EXPECT_NE(offset, first);
    first = offset;
  }
}

TEST(SensingTime, JitterHasItsSizeAndStampsStayInOrder) {
  TimeSensingConfig config;
  config.stamp_jitter_ms = 4.0;
  config.odometry_jitter_ms = 40.0;  // of samples that are 50 ms apart
  const Data data = disturbed(config);
  double squares = 0.0;
  for (const auto& frames : data.recording.frames)
    for (int i = 0; i < kStops; ++i) squares += std::pow(frames[static_cast<std::size_t>(i)].stamp_s - 2.0 * i, 2);
  // 800 values: 2.5 % of the deviation, four of them.
  EXPECT_NEAR(std::sqrt(squares / (2.0 * kStops)) / 0.004, 1.0, 0.1);
  for (std::size_t i = 1; i < data.recording.odometry.size(); ++i)
    ASSERT_GT(data.recording.odometry[i].stamp_s, data.recording.odometry[i - 1].stamp_s);
}

TEST(SensingTime, AboutTheShareOfFramesIsDroppedAndNeverAll) {
  TimeSensingConfig config;
  config.dropped_percent = 25.0;
  const Data data = disturbed(config);
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const double dropped = kStops - static_cast<double>(data.recording.frames[camera].size());
    EXPECT_NEAR(dropped / kStops, 0.25, 4.0 * std::sqrt(0.25 * 0.75 / kStops));
    EXPECT_EQ(data.truth.cameras[camera].sensing.at("dropped_frames"), dropped);
  }
  config.dropped_percent = 100.0;
  EXPECT_EQ(disturbed(config).recording.frames[0].size(), 1U);
}

TEST(SensingTime, LateOdometryIsToldInTheTruth) {
  TimeSensingConfig config;
  config.odometry_delay_ms = 80.0;
  const Data data = disturbed(config);
  EXPECT_NEAR(data.recording.odometry[10].stamp_s, 0.5 + 0.08, 1e-12);
  EXPECT_NEAR(data.truth.drawn.at("sensing.time.odometry_delay_ms"), 80.0, 1e-9);
}

TEST(SensingLens, ToldIntrinsicsAreOffByTheFactorysError) {
  Camera camera = Camera::symmetric(1280, 720, 640.0);
  EXPECT_EQ(told_camera(camera, {}, 0, 0).fx_px, 640.0);
  camera.distortion = {0.1, -0.2, 0.0, 0.0, 0.0};
  LensSensingConfig config;
  config.focal_error_percent = Distribution::Kind(Distribution::Normal{0.0, 0.2});
  config.centre_error_px = Distribution::Kind(Distribution::Normal{0.0, 3.0});
  config.distortion_error_percent = 5.0;
  double focal = 0.0, centre = 0.0;
  constexpr int kCameras = 500;
  for (int i = 0; i < kCameras; ++i) {
    const Camera told = told_camera(camera, config, 0, i);
    EXPECT_EQ(told.fx_px, told.fy_px);
    EXPECT_NEAR(told.distortion[1], -0.21, 1e-12);
    focal += std::pow(told.fx_px / 640.0 - 1.0, 2) / kCameras;
    centre += (std::pow(told.cx_px - camera.cx_px, 2) + std::pow(told.cy_px - camera.cy_px, 2)) / (2.0 * kCameras);
  }
  EXPECT_NEAR(std::sqrt(focal) / 0.002, 1.0, 0.13);  // standard error 3.2 %, four of them
  EXPECT_NEAR(std::sqrt(centre) / 3.0, 1.0, 0.09);   // twice as many values
}

TEST(SensingSeed, IsTheRunsUnlessItHasItsOwn) {
  GenerateConfig config;
  config.seed = 4;
  EXPECT_EQ(sensing_seed(config), 4U);
  config.sensing.seed = 9;
  EXPECT_EQ(sensing_seed(config), 9U);
}

TEST(SensingSwitches, NoneLeavesTheSensorsClean) {
  GenerateConfig config;
  config.sensor_noise = "none";
  change(&config, "sensing: {depth: {edges: true}, image: {vignetting: true}}");
  Rig rig;
  rig.cameras.emplace_back().sensor = "d455";
  rig.cameras[0].depth = load_sensor_preset("d455").depth;
  EXPECT_TRUE(resolve_sensors(config, rig, false)[0].labels().empty());
  config.sensor_noise = "realistic";
  const auto labels = resolve_sensors(config, rig, false)[0].labels();
  EXPECT_EQ(labels.count("flying_share"), 1U);
  EXPECT_EQ(labels.count("corner_light_percent"), 1U);
  EXPECT_EQ(labels.count("depth_bias_sigma_px"), 0U);
}

TEST(SensingSwitches, TimeOfFlightIsNearlyBlindOutdoors) {
  GenerateConfig config;
  Rig rig;
  rig.cameras.emplace_back().sensor = "l515";
  rig.cameras[0].depth = load_sensor_preset("l515").depth;
  EXPECT_EQ(resolve_sensors(config, rig, false)[0].labels().count("depth_valid_share"), 0U);
  const SensorModel outdoors = resolve_sensors(config, rig, true)[0];
  EXPECT_EQ(outdoors.labels().at("depth_valid_share"), 0.1);
  EXPECT_EQ(outdoors.depth->stream.max_m, 2.0);
  change(&config, "sensing: {depth: {daylight: false}}");
  EXPECT_EQ(resolve_sensors(config, rig, true)[0].depth->stream.max_m, 9.0);
}

}  // namespace
}  // namespace rigproof
