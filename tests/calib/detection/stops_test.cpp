#include "rigproof/calib/vision/stops.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "error_text.h"
#include "odometry_track.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "worded.h"

namespace rigproof::detection {
namespace {

// Drives a circle of 2 m radius at 0.5 m/s, sampled at 20 Hz.
std::vector<OdometrySample> circle(double seconds) {
  std::vector<OdometrySample> samples;
  for (int i = 0; i * 0.05 <= seconds; ++i) {
    const double t = i * 0.05, yaw = 0.25 * t;
    samples.push_back({t, 2.0 * std::sin(yaw), 2.0 - 2.0 * std::cos(yaw), yaw});
  }
  return samples;
}

Recording recording_with(std::vector<std::vector<double>> stamps, std::vector<OdometrySample> odometry) {
  Recording recording;
  recording.folder = "somewhere";
  recording.odometry = std::move(odometry);
  for (std::size_t camera = 0; camera < stamps.size(); ++camera) {
    recording.rig.cameras.emplace_back();
    recording.frames.emplace_back();
    for (std::size_t i = 0; i < stamps[camera].size(); ++i) {
      CameraFrame frame;
      frame.color_file = std::to_string(camera) + "/" + std::to_string(i) + ".png";
      frame.stamp_s = stamps[camera][i];
      recording.frames.back().push_back(frame);
    }
  }
  return recording;
}

TEST(OdometryTrack, FollowsArcsBetweenSamples) {
  const std::vector<OdometrySample> samples = circle(10.0);
  const OdometryTrack track(samples, 0.5, 0.02);
  Finding why_not;
  for (const double t : {0.0, 0.017, 3.333, 9.99}) {
    const auto reading = track.at(t, &why_not);
    ASSERT_TRUE(reading.has_value());
    // Constant twist: the interpolation is exact up to rounding.
    EXPECT_NEAR(reading->x_m, 2.0 * std::sin(0.25 * t), 1e-12);
    EXPECT_NEAR(reading->y_m, 2.0 - 2.0 * std::cos(0.25 * t), 1e-12);
    EXPECT_NEAR(reading->yaw_rad, 0.25 * t, 1e-12);
  }
  EXPECT_EQ(track.at(samples[7].stamp_s, &why_not)->sigma_m, 0.0);
}

// A robot that speeds up while it turns ever faster, at so many rows a second.
std::vector<OdometrySample> speeding_up(double rate_hz) {
  Vector6d velocity = Vector6d::Zero(), acceleration = Vector6d::Zero();
  velocity[0] = 0.3;
  velocity[5] = 0.2;
  acceleration[0] = 0.8;
  acceleration[5] = -2.5;
  std::vector<OdometrySample> samples;
  for (int i = 0; i <= rate_hz; ++i) {
    const double t = i / rate_hz - 0.5;
    const Rigid3 T = planar_pose(3.0, -2.0, 2.0) * se3_exp(t * velocity + 0.5 * t * t * acceleration);
    samples.push_back({t, T.translation.x(), T.translation.y(), yaw_of(T)});
  }
  return samples;
}

TEST(OdometryTrack, TellsHowARobotSpeedsUp) {
  const std::vector<OdometrySample> samples = speeding_up(50.0), sparse = speeding_up(20.0);
  const Eigen::Vector3d expected(0.8, 0.0, -2.5);
  EXPECT_LT((OdometryTrack(samples, 0.5, 0.02).acceleration_at(0.0) - expected).norm(), 2e-2);
  EXPECT_TRUE(OdometryTrack(sparse, 0.5, 0.02).acceleration_at(0.0).isZero(0.0)) << "too few rows";
  std::vector<OdometrySample> wild = samples;
  wild[wild.size() / 2 + 3].yaw_rad += 0.5;
  EXPECT_FALSE(OdometryTrack(wild, 0.5, 0.02).velocity_at(0.0).isZero(0.0));
  EXPECT_TRUE(OdometryTrack(wild, 0.5, 0.02).acceleration_at(0.0).isZero(0.0)) << "no robot turns so suddenly";
  std::vector<OdometrySample> standing = samples;
  for (OdometrySample& sample : standing) sample = {sample.stamp_s, 1.0, 2.0, 0.5};
  EXPECT_TRUE(OdometryTrack(standing, 0.5, 0.02).acceleration_at(0.0).isZero(0.0));
}

Stop stop_at(const OdometrySample& sample) { return {sample.stamp_s, sample.x_m, sample.y_m, sample.yaw_rad, 0.0}; }

// Stands, turns by one radian, drives two metres, turns back by half a radian and stands, at 50 Hz.
std::vector<OdometrySample> turn_drive_turn() {
  std::vector<OdometrySample> samples;
  const auto clamped = [](double t) { return std::min(1.0, std::max(0.0, t)); };
  for (int i = 0; i <= 250; ++i) {
    const double t = 0.02 * i, first = clamped(t - 0.5), way = 2.0 * clamped(t - 2.0), second = clamped(t - 3.5);
    samples.push_back({t, way * std::cos(1.0), way * std::sin(1.0), first - 0.5 * second});
  }
  return samples;
}

TEST(OdometryTrack, KeepsTheCornersOfTheWay) {
  const std::vector<OdometrySample> samples = turn_drive_turn();
  const OdometryTrack track(samples, 0.5, 0.02);
  const std::vector<Eigen::Vector3d> way = track.way(stop_at(samples.front()), stop_at(samples.back()));
  ASSERT_EQ(way.size(), 2U);
  EXPECT_LT((way[0] - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 1e-3);
  EXPECT_LT((way[1] - Eigen::Vector3d(2.0 * std::cos(1.0), 2.0 * std::sin(1.0), 1.0)).norm(), 1e-3);
}

TEST(OdometryTrack, AnArcNeedsNoPosesInBetween) {
  const std::vector<OdometrySample> samples = circle(10.0);  // 2.5 rad
  const OdometryTrack track(samples, 0.5, 0.02);
  EXPECT_TRUE(track.way(stop_at(samples.front()), stop_at(samples.back())).empty());
}

// Seven quarters of a turn end where a quarter back does: the way tells them apart.
TEST(OdometryTrack, CountsFullTurns) {
  std::vector<OdometrySample> samples;
  for (int i = 0; i <= 175; ++i)
    samples.push_back({0.02 * i, 0.0, 0.0, std::remainder(0.01 * kPi * 2.0 * i, 2.0 * kPi)});
  const OdometryTrack track(samples, 0.5, 0.02);
  double last = samples.front().yaw_rad, turned = 0.0;
  std::vector<Eigen::Vector3d> way = track.way(stop_at(samples.front()), stop_at(samples.back()));
  way.emplace_back(0.0, 0.0, samples.back().yaw_rad);
  for (const Eigen::Vector3d& pose : way) {
    turned += std::remainder(pose.z() - last, 2.0 * kPi);
    last = pose.z();
  }
  EXPECT_NEAR(turned, 3.5 * kPi, 1e-9);
}

TEST(OdometryTrack, AGapHidesTheWay) {
  std::vector<OdometrySample> samples = turn_drive_turn();
  samples.erase(samples.begin() + 100, samples.begin() + 140);
  const OdometryTrack track(samples, 0.5, 0.02);
  EXPECT_TRUE(track.way(stop_at(samples.front()), stop_at(samples.back())).empty());
}

TEST(OdometryTrack, StatesItsInterpolationError) {
  // Accelerates at 1 m/s^2, sampled every 0.2 s: the twist between samples is off by up to 5 mm.
  std::vector<OdometrySample> samples;
  for (int i = 0; i < 20; ++i) samples.push_back({0.2 * i, 0.5 * 0.04 * i * i, 0.0, 0.0});
  const OdometryTrack track(samples, 0.5, 0.02);
  Finding why_not;
  const double t = 2.1;
  const auto reading = track.at(t, &why_not);
  ASSERT_TRUE(reading.has_value());
  const double error = std::abs(reading->x_m - 0.5 * t * t);
  EXPECT_NEAR(error, 0.005, 1e-9);
  EXPECT_NEAR(reading->sigma_m, error, 1e-9);
}

TEST(OdometryTrack, NamesGapsAndEnds) {
  std::vector<OdometrySample> samples = circle(10.0);
  samples.erase(samples.begin() + 41, samples.begin() + 80);  // 2.00 to 4.00 s
  const OdometryTrack track(samples, 0.5, 0.02);
  Finding why_not;
  EXPECT_FALSE(track.at(3.0, &why_not));
  EXPECT_EQ(worded(why_not), "odometry gap of 2.00 s (2.000 to 4.000 s)");
  EXPECT_FALSE(track.at(11.0, &why_not));
  EXPECT_EQ(worded(why_not), "no odometry (at 11.000 s; it covers 0.000 to 10.000 s)");
  // A sample 15 ms away serves, with the way covered in that time as its uncertainty.
  const auto near = track.at(10.015, &why_not);
  ASSERT_TRUE(near.has_value());
  EXPECT_NEAR(near->sigma_m, 0.5 * 0.015, 1e-4);
  EXPECT_FALSE(OdometryTrack({}, 0.5, 0.02).at(0.0, &why_not));
}

TEST(OdometryTrack, YawWrapsTheShortWay) {
  const std::vector<OdometrySample> samples = {{0.0, 0.0, 0.0, 3.1}, {0.1, 0.0, 0.0, -3.1}};
  Finding why_not;
  const auto reading = OdometryTrack(samples, 0.5, 0.02).at(0.05, &why_not);
  EXPECT_NEAR(std::abs(std::remainder(reading->yaw_rad, 2.0 * M_PI)), M_PI, 1e-9);
}

TEST(Stops, JoinFramesOfOneMoment) {
  const Recording recording = recording_with({{1.0, 2.0, 3.0}, {1.015, 2.01}, {0.995, 3.004}}, circle(10.0));
  const StopPlan plan = plan_stops(recording, {});
  ASSERT_EQ(plan.stops.size(), 3U);
  EXPECT_TRUE(plan.exclusions.empty());
  EXPECT_EQ(plan.stops[0].frames[2], std::vector<int>{0});
  EXPECT_TRUE(plan.stops[1].frames[2].empty());
  EXPECT_EQ(plan.stops[2].frames[2], std::vector<int>{1});
  EXPECT_NEAR(plan.stops[0].stop.stamp_s, 1.0, 1e-12);
}

TEST(Stops, AStandstillIsOneStop) {
  // Stands from 0 to 2 s, drives 1 m until 4 s, stands until 6 s; a camera at 10 Hz.
  std::vector<OdometrySample> odometry;
  for (int i = 0; i <= 120; ++i) {
    const double t = 0.05 * i;
    odometry.push_back({t, std::min(std::max(0.0, 0.5 * (t - 2.0)), 1.0), 0.0, 0.0});
  }
  std::vector<double> stamps;
  for (int i = 0; i <= 60; ++i) stamps.push_back(0.1 * i);
  const Recording recording = recording_with({stamps}, odometry);
  const StopPlan plan = plan_stops(recording, {});
  // 21 frames stand, 19 drive, 21 stand.
  ASSERT_EQ(plan.stops.size(), 21U);
  EXPECT_EQ(plan.stops.front().frames[0], (std::vector<int>{0, 10, 20}));
  EXPECT_EQ(plan.stops.back().frames[0], (std::vector<int>{40, 50, 60}));
  EXPECT_NEAR(plan.stops.back().stop.x_m, 1.0, 1e-12);
  EXPECT_EQ(plan.exclusions.size(), 36U);
  EXPECT_EQ(plan.exclusions.front().why, Finding("frame.surplus"));
}

// The odometer stands still, the images do not: every moment is a stop again.
TEST(Stops, AStandstillThatTheImagesDenyIsNone) {
  std::vector<OdometrySample> odometry;
  for (int i = 0; i <= 120; ++i) odometry.push_back({0.05 * i, 0.0, 0.0, 0.0});
  const Recording recording = recording_with({{1.0, 2.0, 4.0, 5.0}, {1.01, 2.01, 4.01, 5.01}}, odometry);
  EXPECT_EQ(plan_stops(recording, {}).stops.size(), 1U);
  const StopPlan plan = plan_stops(recording, {}, {{1.0, 5.01}});
  ASSERT_EQ(plan.stops.size(), 4U);
  for (const PlannedStop& stop : plan.stops)
    for (const std::vector<int>& frames : stop.frames) EXPECT_EQ(frames.size(), 1U);
}

TEST(Stops, FramesWithoutOdometryAreNamed) {
  const StopPlan plan = plan_stops(recording_with({{1.0, 2.0, 99.0}}, circle(10.0)), {});
  EXPECT_EQ(plan.stops.size(), 2U);
  ASSERT_EQ(plan.exclusions.size(), 1U);
  EXPECT_EQ(plan.exclusions[0].stop, -1);
  EXPECT_EQ(plan.exclusions[0].file, "0/2.png");
}

TEST(Stops, RefuseWhatCannotBeAnswered) {
  EXPECT_THROW(plan_stops(recording_with({{}, {}}, circle(1.0)), {}), Error);
  EXPECT_THAT(error_text([] {
                plan_stops(recording_with({{1000.0, 1001.0}}, circle(1.0)), {});
              }),
              testing::HasSubstr("odometry covers 0.000 to 1.000 s, the frames 1000.000 to 1001.000 s"));
}

// On the spot about a point 0.2 m ahead of the robot's origin: the wheels tell no motion, the origin swings around it.
TEST(Stops, AreOfTheOriginOfARobotThatTurnsAboutAnotherPoint) {
  std::vector<OdometrySample> odometry;
  for (int i = 0; i <= 80; ++i) odometry.push_back({0.05 * i, 1.0, 2.0, 0.5 * 0.05 * i});
  Recording recording = recording_with({{1.0, 3.0}}, odometry);
  recording.rig.odometry_noise.rotation_centre_m << 0.2, 0.0;
  const StopPlan plan = plan_stops(recording, {});
  ASSERT_EQ(plan.stops.size(), 2U);
  const Stop &first = plan.stops[0].stop, &last = plan.stops[1].stop;
  EXPECT_NEAR(first.x_m, 1.0 - 0.2 * std::cos(0.5), 1e-12);
  EXPECT_NEAR(first.y_m, 2.0 - 0.2 * std::sin(0.5), 1e-12);
  EXPECT_NEAR(last.x_m, 1.0 - 0.2 * std::cos(1.5), 1e-12);
  EXPECT_NEAR(last.y_m, 2.0 - 0.2 * std::sin(1.5), 1e-12);
  EXPECT_NEAR(last.yaw_rad, 1.5, 1e-12);
  EXPECT_NEAR(first.velocity.y(), -0.2 * 0.5, 1e-9);
}

TEST(Stops, FramesOfASegmentAreNone) {
  Recording recording = recording_with({{0.0, 1.0, 2.0, 3.0, 4.0}}, circle(10.0));
  ASSERT_EQ(plan_stops(recording, {}).stops.size(), 5U);
  recording.segments = {{kStraightSegment, 1.5, 3.5}};
  const StopPlan plan = plan_stops(recording, {});
  ASSERT_EQ(plan.stops.size(), 3U);
  EXPECT_EQ(plan.stops[2].stop.stamp_s, 4.0);
  EXPECT_EQ(plan.stops[2].frames[0], std::vector<int>{4});
  EXPECT_TRUE(plan.exclusions.empty());
}

}  // namespace
}  // namespace rigproof::detection
