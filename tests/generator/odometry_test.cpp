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

TEST(Odometry, AMotionIsATurnAWayAndATurn) {
  RandomStream random(3, "decompose");
  for (int i = 0; i < 500; ++i) {
    const Rigid3 T = planar_pose(random.normal(), random.normal(), random.uniform(-kPi, kPi));
    const TurnDriveTurn parts = decompose(T);
    EXPECT_LT(se3_log(parts.motion().inverse() * T).norm(), 1e-12);
    EXPECT_LE(std::abs(parts.first_rad), 0.5 * kPi) << "the robot drives backwards rather than turn more";
  }
  EXPECT_EQ(decompose(planar_pose(0.0, 0.0, 0.7)).first_rad, 0.0);
}

TEST(Odometry, NewModelsWithoutErrorAreTheTruth) {
  const std::vector<TrueStop> stops = winding_drive(30);
  for (const OdometryLaw law : {OdometryLaw::kThrun, OdometryLaw::kWheels}) {
    OdometrySimulation simulation;
    simulation.law = law;
    const std::vector<OdometrySample> samples = simulate_odometry(stops, simulation, 0);
    for (std::size_t i = 0; i < stops.size(); ++i) {
      EXPECT_NEAR(samples[i].x_m, stops[i].T_world_robot.translation.x(), 1e-12);
      EXPECT_NEAR(wrap_angle(samples[i].yaw_rad - yaw_of(stops[i].T_world_robot)), 0.0, 1e-12);
    }
  }
}

// The same motion again and again.
std::vector<TrueStop> repeated(const Rigid3& motion, int count) {
  std::vector<TrueStop> stops;
  Rigid3 T;
  for (int i = 0; i <= count; ++i, T = T * motion) stops.push_back({static_cast<double>(i), T});
  return stops;
}

TEST(Odometry, ThrunsVariancesGrowWithTheMotion) {
  const TurnDriveTurn motion{0.6, 1.7, -0.3};
  OdometrySimulation simulation;
  simulation.law = OdometryLaw::kThrun;
  simulation.thrun = {0.01, 0.002, 0.004, 0.003};
  const std::vector<OdometrySample> samples = simulate_odometry(repeated(motion.motion(), 4000), simulation, 8);
  Moments first, way, second;
  std::vector<double> errors;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const TurnDriveTurn measured = decompose(pose_of(samples[i - 1]).inverse() * pose_of(samples[i]));
    first.add(measured.first_rad - motion.first_rad);
    way.add(measured.way_m - motion.way_m);
    second.add(measured.second_rad - motion.second_rad);
    errors.push_back(measured.way_m - motion.way_m);
  }
  expect_normal(first, std::sqrt(0.01 * 0.36 + 0.002 * 2.89));
  expect_normal(way, std::sqrt(0.004 * 2.89 + 0.003 * (0.36 + 0.09)));
  expect_normal(second, std::sqrt(0.01 * 0.09 + 0.002 * 2.89));
  expect_independent(errors);
}

OdometrySimulation with_wheels(const WheelErrors& errors) {
  OdometrySimulation simulation;
  simulation.law = OdometryLaw::kWheels;
  simulation.wheels = errors;
  return simulation;
}

// UMBmark's square: four sides of `side` metres, with turns to the left (1) or to the right (-1).
std::vector<TrueStop> square(double side, int direction) {
  return repeated(planar_pose(side, 0.0, direction * 0.5 * kPi), 4);
}

TEST(Odometry, UmbmarksSquareTellsItsTwoErrorsApart) {
  constexpr double kTrack = 0.6, kSide = 4.0;
  // A wrong track turns every corner too far, to either side: "type A". By Borenstein and Feng's sign convention the
  // true track is wider, so that the driver believes in more turn than there was.
  WheelErrors track;
  track.nominal_track_m = kTrack;
  track.track_ratio = 1.01;
  for (const int direction : {1, -1}) {
    const OdometrySample end = simulate_odometry(square(kSide, direction), with_wheels(track), 0).back();
    EXPECT_NEAR(end.yaw_rad, direction * 2.0 * kPi * 0.01, 1e-12);
  }
  // Unequal wheels bend every side the same way, whichever way round: "type B".
  WheelErrors diameter;
  diameter.nominal_track_m = kTrack;
  diameter.diameter_ratio = 1.004;
  const double left = 2.0 / 2.004, right = 2.0 * 1.004 / 2.004;
  for (const int direction : {1, -1}) {
    const OdometrySample end = simulate_odometry(square(kSide, direction), with_wheels(diameter), 0).back();
    const double sides = 4.0 * kSide * (1.0 / right - 1.0 / left) / kTrack;
    const double corners = direction * 2.0 * kPi * (0.5 / right + 0.5 / left);
    EXPECT_NEAR(end.yaw_rad, wrap_angle(sides + corners), 1e-12);
    EXPECT_LT(sides, 0.0) << "a larger right wheel turns less on the same way";
  }
}

TEST(Odometry, ATurnAboutAnotherCentreMovesTheRobotUnseen) {
  WheelErrors errors;
  errors.icr_x_m = -0.1;
  // The point 0.1 m behind the origin stays where it is: the encoders tell a turn on the spot.
  const Rigid3 centre = planar_pose(-0.1, 0.0, 0.0);
  const Rigid3 motion = centre * planar_pose(0.0, 0.0, 0.8) * centre.inverse();
  OdometrySample end = simulate_odometry(repeated(motion, 1), with_wheels(errors), 0).back();
  EXPECT_NEAR(end.x_m, 0.0, 1e-12);
  EXPECT_NEAR(end.y_m, 0.0, 1e-12);
  EXPECT_NEAR(end.yaw_rad, 0.8, 1e-12);
  // Centres of the tracks that lie to the left of the middle: a turn on the spot drives the wheels backwards as well.
  errors.icr_x_m = 0.0;
  errors.icr_asymmetry_m = 0.05;
  end = simulate_odometry(repeated(planar_pose(0.0, 0.0, 0.8), 1), with_wheels(errors), 0).back();
  EXPECT_NEAR(std::hypot(end.x_m, end.y_m), 0.05 * 2.0 * std::sin(0.4), 1e-12);
  EXPECT_LT(end.x_m, 0.0);
  EXPECT_NEAR(end.yaw_rad, 0.8, 1e-12);
}

TEST(Odometry, SlipScattersEitherSideByItsWay) {
  WheelErrors errors;
  errors.nominal_track_m = 0.5;
  errors.slip = 0.02;
  const std::vector<OdometrySample> samples =
      simulate_odometry(repeated(planar_pose(2.0, 0.0, 0.0), 4000), with_wheels(errors), 6);
  Moments turns;
  for (std::size_t i = 1; i < samples.size(); ++i) turns.add(wrap_angle(samples[i].yaw_rad - samples[i - 1].yaw_rad));
  expect_normal(turns, std::sqrt(2.0) * 0.02 * 2.0 / 0.5);
}

TEST(Odometry, TicksAreWholeAndNoneIsLost) {
  WheelErrors errors;
  errors.way_of_tick_m = 0.01;
  const std::vector<OdometrySample> samples =
      simulate_odometry(repeated(planar_pose(0.1234, 0.0, 0.0), 500), with_wheels(errors), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].x_m / 0.01, std::round(samples[i].x_m / 0.01), 1e-6);
    EXPECT_LE(std::abs(samples[i].x_m - 0.1234 * static_cast<double>(i)), 0.01 + 1e-9);
  }
}

}  // namespace
}  // namespace rigproof
