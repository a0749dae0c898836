// The two noise models against their definitions: exact without noise, moments with it.
#include "rigproof/generator/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

std::vector<TrueStop> winding_drive(int count) {
  std::vector<TrueStop> stops;
  Rigid3 T_world_robot;
  for (int i = 0; i < count; ++i) {
    stops.push_back({2.0 * i, T_world_robot});
    T_world_robot = T_world_robot * planar_pose(0.5 + 0.1 * (i % 3), 0.2 * (i % 2), 0.9 * std::sin(i));
  }
  return stops;
}

OdometrySimulation exact(OdometryModel model) {
  OdometrySimulation simulation;
  simulation.model = model;
  return simulation;
}

TEST(Odometry, WithoutNoiseIsTheTruth) {
  const std::vector<TrueStop> stops = winding_drive(30);
  for (const OdometryModel model : {OdometryModel::kPerPose, OdometryModel::kPerIncrement}) {
    const std::vector<OdometrySample> samples = simulate_odometry(stops, exact(model), 0);
    ASSERT_EQ(samples.size(), stops.size());
    for (std::size_t i = 0; i < stops.size(); ++i) {
      EXPECT_EQ(samples[i].stamp_s, stops[i].stamp_s);
      // Rounding of some thirty products.
      EXPECT_NEAR(samples[i].x_m, stops[i].T_world_robot.translation.x(), 1e-12);
      EXPECT_NEAR(samples[i].y_m, stops[i].T_world_robot.translation.y(), 1e-12);
      EXPECT_NEAR(wrap_angle(samples[i].yaw_rad - yaw_of(stops[i].T_world_robot)), 0.0, 1e-12);
    }
  }
}

struct Moments {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(squares / count); }
};

// Four standard errors of a mean of n: 4 sigma / sqrt(n); of a standard deviation: 4 sigma / sqrt(2 n).
void expect_normal(const Moments& moments, double sigma) {
  EXPECT_NEAR(moments.mean(), 0.0, 4.0 * sigma / std::sqrt(moments.count));
  EXPECT_NEAR(moments.deviation(), sigma, 4.0 * sigma / std::sqrt(2.0 * moments.count));
}

// Correlation of neighbours is zero if they are independent; its standard error is 1 / sqrt(n).
void expect_independent(const std::vector<double>& values) {
  double product = 0.0, square = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    product += values[i - 1] * values[i];
    square += values[i] * values[i];
  }
  EXPECT_NEAR(product / square, 0.0, 4.0 / std::sqrt(static_cast<double>(values.size())));
}

TEST(Odometry, PerPoseNoiseIsIndependentOnEveryPose) {
  const std::vector<TrueStop> stops = winding_drive(4000);
  OdometrySimulation simulation = exact(OdometryModel::kPerPose);
  simulation.sigma_xy_m = 0.02;
  simulation.sigma_yaw_rad = 0.1;
  const std::vector<OdometrySample> samples = simulate_odometry(stops, simulation, 5);
  Moments x, y, yaw;
  std::vector<double> errors_x;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const Rigid3& T = stops[i].T_world_robot;
    errors_x.push_back(samples[i].x_m - T.translation.x());
    x.add(errors_x.back());
    y.add(samples[i].y_m - T.translation.y());
    yaw.add(wrap_angle(samples[i].yaw_rad - yaw_of(T)));
  }
  expect_normal(x, 0.02);
  expect_normal(y, 0.02);
  expect_normal(yaw, 0.1);
  expect_independent(errors_x);
}

Rigid3 pose_of(const OdometrySample& sample) { return planar_pose(sample.x_m, sample.y_m, sample.yaw_rad); }

TEST(Odometry, PerIncrementNoiseIsIndependentOnEveryMotion) {
  const std::vector<TrueStop> stops = winding_drive(4000);
  OdometrySimulation simulation = exact(OdometryModel::kPerIncrement);
  simulation.sigma_xy_m = 0.02;
  simulation.sigma_yaw_rad = 0.1;
  simulation.scale = 1.03;
  simulation.yaw_factor = 0.95;
  const std::vector<OdometrySample> samples = simulate_odometry(stops, simulation, 5);
  EXPECT_EQ(samples.front().x_m, 0.0);
  EXPECT_EQ(samples.front().yaw_rad, 0.0);
  Moments x, y, yaw;
  std::vector<double> errors_yaw;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const Rigid3 measured = pose_of(samples[i - 1]).inverse() * pose_of(samples[i]);
    const Rigid3 truth = stops[i - 1].T_world_robot.inverse() * stops[i].T_world_robot;
    x.add(measured.translation.x() - 1.03 * truth.translation.x());
    y.add(measured.translation.y() - 1.03 * truth.translation.y());
    errors_yaw.push_back(wrap_angle(yaw_of(measured) - 0.95 * yaw_of(truth)));
    yaw.add(errors_yaw.back());
  }
  expect_normal(x, 0.02);
  expect_normal(y, 0.02);
  expect_normal(yaw, 0.1);
  expect_independent(errors_yaw);
}

TEST(Odometry, NoiseOfAStopDoesNotDependOnTheOthers) {
  OdometrySimulation simulation = exact(OdometryModel::kPerPose);
  simulation.sigma_xy_m = 0.01;
  const std::vector<OdometrySample> few = simulate_odometry(winding_drive(10), simulation, 3);
  const std::vector<OdometrySample> many = simulate_odometry(winding_drive(50), simulation, 3);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].x_m, many[i].x_m);
  EXPECT_NE(few[1].x_m, simulate_odometry(winding_drive(10), simulation, 4)[1].x_m);
}

TEST(Odometry, RateAddsSamplesBetweenStopsAndKeepsThoseAtStops) {
  const std::vector<TrueStop> stops = winding_drive(5);
  for (const OdometryModel model : {OdometryModel::kPerPose, OdometryModel::kPerIncrement}) {
    OdometrySimulation simulation = exact(model);
    simulation.sigma_xy_m = 0.01;
    const std::vector<OdometrySample> sparse = simulate_odometry(stops, simulation, 0);
    simulation.rate_hz = 50.0;
    const std::vector<OdometrySample> dense = simulate_odometry(stops, simulation, 0);
    ASSERT_EQ(dense.size(), 4U * 100U + 1U);
    for (std::size_t i = 1; i < dense.size(); ++i) EXPECT_LT(dense[i - 1].stamp_s, dense[i].stamp_s);
    for (std::size_t i = 0; i < sparse.size(); ++i) {
      EXPECT_EQ(dense[100 * i].stamp_s, sparse[i].stamp_s);
      EXPECT_EQ(dense[100 * i].x_m, sparse[i].x_m);
    }
  }
}

TEST(Odometry, RobotStandsAroundAStop) {
  const std::vector<TrueStop> stops = winding_drive(3);
  OdometrySimulation simulation = exact(OdometryModel::kPerIncrement);
  simulation.rate_hz = 100.0;
  for (const OdometrySample& sample : simulate_odometry(stops, simulation, 0)) {
    if (std::abs(sample.stamp_s - stops[1].stamp_s) > 0.3) continue;
    EXPECT_NEAR(sample.x_m, stops[1].T_world_robot.translation.x(), 1e-12);
  }
}

}  // namespace
}  // namespace rigproof
