// Disturbed clocks as calibration meets them: frames are matched to the right stop, or left out with the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/calib/vision/stops.h"
#include "rigproof/generator/odometry.h"
#include "sensing/resolve.h"

namespace rigproof {
namespace {

constexpr std::size_t kStops = 12, kCameras = 3;

struct ClockedRun {
  Recording recording;
  Truth truth;
};

// Stops two seconds apart on a curved drive, exact odometry: what is wrong afterwards is the clocks' doing.
ClockedRun run_with(const TimeSensingConfig& clocks, double rate_hz) {
  ClockedRun run;
  for (std::size_t i = 0; i < kStops; ++i) {
    const double s = static_cast<double>(i);
    run.truth.stops.push_back({2.0 * s, planar_pose(0.8 * s, 0.3 * std::sin(s), 0.2 * s)});
  }
  OdometrySimulation exact;
  exact.rate_hz = rate_hz;
  run.recording.odometry = simulate_odometry(run.truth.stops, exact, 0);
  for (std::size_t camera = 0; camera < kCameras; ++camera) {
    run.truth.cameras.emplace_back().name = "camera" + std::to_string(camera);
    std::vector<CameraFrame>& frames = run.recording.frames.emplace_back();
    for (std::size_t i = 0; i < kStops; ++i) {
      CameraFrame frame;
      frame.color_file = std::to_string(camera) + "/" + std::to_string(i) + ".png";
      frame.stamp_s = run.truth.stops[i].stamp_s;
      frames.push_back(frame);
    }
  }
  disturb_time(clocks, 3, &run.recording, &run.truth);
  return run;
}

int number_of(const CameraFrame& frame) { return std::stoi(frame.color_file.substr(frame.color_file.find('/') + 1)); }

std::size_t recorded_frames(const ClockedRun& run) {
  std::size_t count = 0;
  for (const auto& frames : run.recording.frames) count += frames.size();
  return count;
}

// Every frame stands with the others of its stop, at the stop's true place. Only at the ends of the drive one may fall
// outside of the odometry, and is left out.
void expect_matched(const ClockedRun& run) {
  const detection::StopPlan plan = detection::plan_stops(run.recording, {});
  const Rigid3 T_world_first = run.truth.stops.front().T_world_robot;
  std::size_t used = 0;
  for (const Exclusion& exclusion : plan.exclusions) {
    const int number = std::stoi(exclusion.file.substr(exclusion.file.find('/') + 1));
    EXPECT_TRUE(number == 0 || number + 1 == static_cast<int>(kStops)) << exclusion.file << ": " << exclusion.why.code;
    EXPECT_TRUE(exclusion.why.is("odometry.not_covering")) << exclusion.why.code;
  }
  for (const detection::PlannedStop& planned : plan.stops) {
    int stop = -1;
    for (std::size_t camera = 0; camera < planned.frames.size(); ++camera) {
      for (const int index : planned.frames[camera]) {
        const int number = number_of(run.recording.frames[camera][static_cast<std::size_t>(index)]);
        if (stop < 0) stop = number;
        EXPECT_EQ(number, stop);
        ++used;
      }
    }
    const Rigid3 T = T_world_first.inverse() * run.truth.stops[static_cast<std::size_t>(stop)].T_world_robot;
    EXPECT_NEAR(planned.stop.x_m, T.translation.x(), 1e-3) << stop;
    EXPECT_NEAR(planned.stop.y_m, T.translation.y(), 1e-3) << stop;
    EXPECT_NEAR(planned.stop.yaw_rad, wrap_angle(yaw_of(T)), 1e-3) << stop;
  }
  EXPECT_EQ(used + plan.exclusions.size(), recorded_frames(run));
}

// The robot stands for a fifth of the two seconds at either end: 0.4 s in all directions.
TEST(Clocks, WhileTheRobotStandsNoClockMatters) {
  TimeSensingConfig clocks;
  clocks.clock_offset_ms = Distribution::Kind(Distribution::Uniform{-100.0, 100.0});
  clocks.camera_delay_ms = Distribution::Kind(Distribution::Uniform{0.0, 100.0});
  clocks.stamp_jitter_ms = 5.0;
  clocks.odometry_delay_ms = 80.0;
  clocks.odometry_jitter_ms = 2.0;
  expect_matched(run_with(clocks, 20.0));
}

TEST(Clocks, DroppedFramesLeaveTheOthersInTheirPlaces) {
  TimeSensingConfig clocks;
  clocks.dropped_percent = 40.0;
  clocks.clock_offset_ms = 50.0;
  const ClockedRun run = run_with(clocks, 20.0);
  EXPECT_LT(recorded_frames(run), kStops * kCameras);
  expect_matched(run);
}

TEST(Clocks, OneSampleAStopBearsWhatTheToleranceAllows) {
  TimeSensingConfig clocks;
  clocks.stamp_jitter_ms = 4.0;
  expect_matched(run_with(clocks, 0.0));
}

// Odometry that comes a tenth of a second late tells nothing between its samples: said, not guessed.
TEST(Clocks, WhatCannotBeMatchedIsLeftOutWithTheReason) {
  TimeSensingConfig clocks;
  clocks.clock_offset_ms = Distribution::Kind(Distribution::Choice{{0.0, 100.0}});
  const ClockedRun run = run_with(clocks, 0.0);
  const detection::StopPlan plan = detection::plan_stops(run.recording, {});
  std::size_t late = 0;
  for (const TrueCamera& camera : run.truth.cameras) late += camera.sensing.count("clock_offset_s");
  ASSERT_GT(late, 0U);
  ASSERT_LT(late, kCameras);
  EXPECT_EQ(plan.exclusions.size(), late * kStops);
  EXPECT_TRUE(plan.exclusions.front().why.is("odometry.gap")) << plan.exclusions.front().why.code;
}

}  // namespace
}  // namespace rigproof
