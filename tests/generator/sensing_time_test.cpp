// Clocks, dropped frames and told intrinsics.
#include <gtest/gtest.h>

#include <array>
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

RigCamera told_of(const RigCamera& camera, const GenerateConfig& config, std::int32_t index) {
  RigCamera told = camera;
  tell_lens(config, index, &told);
  return told;
}

TEST(SensingLens, ToldIntrinsicsAreOffAsAskedFor) {
  RigCamera rig_camera;
  Camera& camera = rig_camera.camera;
  camera = Camera::symmetric(1280, 720, 640.0);
  GenerateConfig run = plain_config();
  run.sensing.told = "exact";
  EXPECT_EQ(told_of(rig_camera, run, 0).camera.fx_px, 640.0);
  EXPECT_EQ(told_of(rig_camera, run, 0).intrinsics_sigma, IntrinsicsSigma::exact());
  camera.distortion = {0.1, -0.2, 0.0, 0.0, 0.0};
  LensSensingConfig& config = run.sensing.lens;
  config.focal_error_percent = Distribution::Kind(Distribution::Normal{0.0, 0.2});
  config.centre_error_px = Distribution::Kind(Distribution::Normal{0.0, 3.0});
  config.distortion_error_percent = 5.0;
  double focal = 0.0, centre = 0.0;
  constexpr int kCameras = 500;
  for (int i = 0; i < kCameras; ++i) {
    const Camera told = told_of(rig_camera, run, i).camera;
    EXPECT_EQ(told.fx_px, told.fy_px);
    EXPECT_NEAR(told.distortion[1], -0.21, 1e-12);
    focal += std::pow(told.fx_px / 640.0 - 1.0, 2) / kCameras;
    centre += (std::pow(told.cx_px - camera.cx_px, 2) + std::pow(told.cy_px - camera.cy_px, 2)) / (2.0 * kCameras);
  }
  EXPECT_NEAR(std::sqrt(focal) / 0.002, 1.0, 0.13);  // standard error 3.2 %, four of them
  EXPECT_NEAR(std::sqrt(centre) / 3.0, 1.0, 0.09);   // twice as many values
}

// Each quantity spreads as the recording says that it is known; a corner moves by what is said of the distortion.
TEST(SensingTold, LensesAreDrawnAsWellAsTheyAreSaidToBeKnown) {
  RigCamera rig_camera;
  rig_camera.camera = Camera::symmetric(1280, 720, 640.0);
  rig_camera.intrinsics_sigma = {0.004, 0.001, 1.5, 0.5, 0.0};
  const Camera& camera = rig_camera.camera;
  Eigen::Vector3d ray;
  ASSERT_TRUE(camera.unproject({0.0, 0.0}, &ray));
  Eigen::Matrix<double, 5, 1> squares = Eigen::Matrix<double, 5, 1>::Zero();
  constexpr int kCameras = 1000;
  for (int i = 0; i < kCameras; ++i) {
    const RigCamera drawn = told_of(rig_camera, {}, i);
    EXPECT_EQ(drawn.intrinsics_sigma, rig_camera.intrinsics_sigma);
    const Camera& told = drawn.camera;
    Camera bent = camera;
    bent.lens = told.lens;
    bent.distortion = told.distortion;
    Eigen::Vector2d moved;
    ASSERT_TRUE(bent.project(ray, &moved));
    Eigen::Matrix<double, 5, 1> errors;
    errors << std::sqrt(told.fx_px * told.fy_px) / 640.0 - 1.0, told.fx_px / told.fy_px - 1.0,
        told.cx_px - camera.cx_px, told.cy_px - camera.cy_px, moved.norm();
    squares += errors.cwiseAbs2() / kCameras;
  }
  const std::array<double, 5> sigmas = {0.004, 0.001, 1.5, 1.5, 0.5};
  for (Eigen::Index i = 0; i < 5; ++i)
    EXPECT_NEAR(std::sqrt(squares[i]) / sigmas[static_cast<std::size_t>(i)], 1.0, 0.09) << i;  // four of 2.2 %
}

TEST(SensingTold, AnErrorThatIsAskedForReplacesTheOneDrawn) {
  RigCamera camera;
  camera.camera = Camera::symmetric(1280, 720, 640.0);
  GenerateConfig run = plain_config();
  run.sensing.lens.focal_error_percent = 1.0;
  const Camera told = told_of(camera, run, 3).camera;
  EXPECT_DOUBLE_EQ(told.fx_px, 646.4);
  EXPECT_DOUBLE_EQ(told.fy_px, 646.4);
  EXPECT_NE(told.cx_px, camera.camera.cx_px);
}

TEST(SensingTold, NothingIsDrawnForSensorsWithoutNoiseOrWhereAllIsKnown) {
  RigCamera camera;
  camera.camera = Camera::symmetric(1280, 720, 640.0);
  GenerateConfig run = plain_config();
  run.sensor_noise = "none";
  EXPECT_EQ(told_of(camera, run, 0).camera.fx_px, 640.0);
  EXPECT_EQ(told_of(camera, run, 0).intrinsics_sigma, IntrinsicsSigma::exact());
  run.sensor_noise = "realistic";
  camera.intrinsics_sigma = IntrinsicsSigma::exact();
  EXPECT_EQ(told_of(camera, run, 0).camera.cx_px, camera.camera.cx_px);
}

// People know the readout of a camera where they know everything of it.
TEST(SensingTold, TheReadoutOfImagesTakenAtSpeedIsToldWhereNothingIsDrawn) {
  const auto told = [](const std::string& capture, const std::string& told_is) {
    GenerateConfig run = plain_config();
    run.motion = "drive";
    run.drive.capture = capture;
    run.sensing.told = told_is;
    RigCamera camera;
    tell_readout(run, 0.02, &camera);
    return std::pair(camera.readout_s, camera.readout_sigma_s);
  };
  EXPECT_EQ(told("moving", "exact"), std::pair(0.02, 0.0));
  EXPECT_EQ(told("moving", "drawn"), std::pair(0.0, 0.015));
  EXPECT_EQ(told("standing", "exact"), std::pair(0.0, 0.015));
}

TEST(SensingTold, SquaresAndDepthScalesAreDrawnWithWhatCamerasOfASensorShare) {
  GenerateConfig run = plain_config();
  Rig rig;
  rig.cameras.resize(3);
  for (RigCamera& camera : rig.cameras) {
    camera.sensor = "d455";
    camera.depth = DepthStream();
    camera.depth->noise.scale_sigma = 0.003;
  }
  rig.cameras[2].sensor = "l515";
  double sides = 0.0, shared = 0.0, apart = 0.0, of_others = 0.0;
  constexpr int kRuns = 1000;
  for (run.seed = 0; run.seed < kRuns; ++run.seed) {
    Board board;
    const double true_m = board.square_m;
    tell_board(run, 0, &board);
    EXPECT_FALSE(board.square_sigma_m.has_value());
    EXPECT_EQ(board.print_sigma(), 0.0);
    sides += std::pow(board.square_m / true_m - 1.0, 2) / kRuns;
    double scales[3];
    for (std::int32_t i = 0; i < 3; ++i) {
      DeviceDraws draws({sensing_seed(run), -1, i});
      scales[i] = depth_scale_of(run, rig, i, &draws) - 1.0;
    }
    of_others += scales[0] * scales[2] / kRuns;
    shared += scales[0] * scales[1] / kRuns;
    apart += std::pow(scales[0] - scales[1], 2) / 2.0 / kRuns;
  }
  EXPECT_NEAR(std::sqrt(sides) / 0.005, 1.0, 0.09);
  EXPECT_NEAR(std::sqrt(shared) / 0.01, 1.0, 0.09);
  EXPECT_NEAR(std::sqrt(apart) / 0.003, 1.0, 0.09);
  EXPECT_NEAR(of_others / (0.01 * 0.01), 0.0, 0.12);
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
  change(&config, "sensing: {depth: {bias_field: false}}");
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
