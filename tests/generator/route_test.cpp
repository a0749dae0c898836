// Routes among synthetic obstacles, replayed step by step; the encoders' odometry and the trajectory in closed form.
#include "rigproof/generator/route.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/generator/motion.h"
#include "rigproof/generator/wheel_odometer.h"

namespace rigproof {
namespace {

// A long thin robot: where it passes depends on its heading.
constexpr double kLength = 1.0, kWidth = 0.4;
const FloorArea kArea{-5.0, 5.0, -5.0, 5.0};

struct Pillar {
  Eigen::Vector2d at;
  double radius;
};

std::string hit(const std::vector<Pillar>& pillars, const FloorPose& pose) {
  for (const Pillar& pillar : pillars) {
    const Eigen::Rotation2Dd to_robot(-pose.yaw_rad);
    const Eigen::Vector2d p = (to_robot * (pillar.at - pose.position)).cwiseAbs();
    const Eigen::Vector2d outside = (p - Eigen::Vector2d(kLength / 2, kWidth / 2)).cwiseMax(0.0);
    if (outside.norm() < pillar.radius) return "pillar";
  }
  return {};
}

std::vector<Pillar> wall(double x, double y_from, double y_to) {
  std::vector<Pillar> pillars;
  for (double y = y_from; y <= y_to; y += 0.1) pillars.push_back({{x, y}, 0.12});
  return pillars;
}

// Follows every leg in steps of a centimetre or half a degree; the pose at the end.
FloorPose replay(const Route& route, FloorPose pose, const std::vector<Pillar>& pillars) {
  for (const RouteLeg& leg : route) {
    if (leg.kind == RouteLeg::Kind::kTurn) {
      const int steps = 1 + static_cast<int>(std::abs(leg.turn_rad) / 0.01);
      for (int i = 1; i <= steps; ++i)
        EXPECT_EQ(hit(pillars, {pose.position, pose.yaw_rad + leg.turn_rad * i / steps}), "");
      EXPECT_NEAR(wrap_angle(pose.yaw_rad + leg.turn_rad - leg.end.yaw_rad), 0.0, 1e-9);
    } else {
      const double distance = (leg.end.position - pose.position).norm() * (leg.backwards ? -1.0 : 1.0);
      EXPECT_LT((pose.ahead(distance) - leg.end.position).norm(), 1e-9) << "a straight way leads along the heading";
      const int steps = 1 + static_cast<int>(std::abs(distance) / 0.01);
      for (int i = 1; i <= steps; ++i) EXPECT_EQ(hit(pillars, {pose.ahead(distance * i / steps), pose.yaw_rad}), "");
    }
    pose = leg.end;
  }
  return pose;
}

RoutePlanner planner(const std::vector<Pillar>& pillars) {
  return RoutePlanner(kArea, [pillars](const FloorPose& pose) { return hit(pillars, pose); });
}

void expect_reaches(const Route& route, const FloorPose& start, const FloorPose& goal,
                    const std::vector<Pillar>& pillars) {
  const FloorPose end = replay(route, start, pillars);
  EXPECT_LT((end.position - goal.position).norm(), 1e-9);
  EXPECT_NEAR(wrap_angle(end.yaw_rad - goal.yaw_rad), 0.0, 1e-9);
}

TEST(Route, OnFreeFloorTurnsDrivesAndTurns) {
  RoutePlanner free = planner({});
  const FloorPose start{{0.0, 0.0}, 0.3}, goal{{2.0, 1.0}, -1.0};
  const auto route = free.route(start, goal, 0);
  ASSERT_TRUE(route);
  EXPECT_EQ(route->size(), 3U);
  expect_reaches(*route, start, goal, {});
}

TEST(Route, GoesBackwardsToWhatLiesBehind) {
  RoutePlanner free = planner({});
  const auto route = free.route({{0.0, 0.0}, 0.0}, {{-2.0, 0.1}, 0.0}, 0);
  ASSERT_TRUE(route);
  double turned = 0.0;
  for (const RouteLeg& leg : *route) turned += std::abs(leg.turn_rad);
  EXPECT_LT(turned, 0.2);
}

TEST(Route, FindsAWayAroundAWall) {
  const std::vector<Pillar> pillars = wall(0.0, -5.0, 3.0);
  RoutePlanner walled = planner(pillars);
  const FloorPose start{{-2.0, -3.0}, 1.5}, goal{{2.0, -3.0}, 0.0};
  const auto route = walled.route(start, goal, 0);
  ASSERT_TRUE(route);
  EXPECT_GT(route->size(), 3U);
  expect_reaches(*route, start, goal, pillars);
}

TEST(Route, LeavesAGarageWhereItCannotTurn) {
  std::vector<Pillar> pillars;
  for (double x = -1.0; x <= 1.0; x += 0.1) {
    pillars.push_back({{x, 0.4}, 0.1});
    pillars.push_back({{x, -0.4}, 0.1});
  }
  RoutePlanner garage = planner(pillars);
  const FloorPose start{{0.0, 0.0}, 0.0}, goal{{0.0, 2.0}, 0.0};
  const auto route = garage.route(start, goal, 0);
  ASSERT_TRUE(route);
  expect_reaches(*route, start, goal, pillars);
}

TEST(Route, OffersOtherWaysOneAfterTheOther) {
  RoutePlanner free = planner({});
  const FloorPose start{{0.0, 0.0}, 0.0}, goal{{2.0, 0.0}, 1.0};
  std::vector<double> lengths;
  for (int number = 0; number < 4; ++number) {
    const auto route = free.route(start, goal, number);
    ASSERT_TRUE(route);
    expect_reaches(*route, start, goal, {});
    double length = 0.0;
    for (const RouteLeg& leg : *route) length += std::abs(leg.turn_rad) + leg.end.position.norm();
    for (const double other : lengths) EXPECT_GT(std::abs(length - other), 1e-6);
    lengths.push_back(length);
  }
}

TEST(Route, NamesWhatIsInBetween) {
  const std::vector<Pillar> pillars = wall(0.0, -5.0, 5.0);
  RoutePlanner split = planner(pillars);
  EXPECT_FALSE(split.route({{-2.0, 0.0}, 0.0}, {{2.0, 0.0}, 0.0}, 0));
  EXPECT_EQ(split.last_obstacle(), "pillar");
  EXPECT_FALSE(planner({}).route({{0.0, 0.0}, 0.0}, {{9.0, 0.0}, 0.0}, 0)) << "beyond the drivable area";
}

TEST(WheelOdometer, FollowsAnArcExactly) {
  const WheelGeometry wheels{0.1, 0.5, 0.0};
  WheelOdometer odometer(wheels, 1.0, 2.0);
  // Half a circle to the left with a radius of 1 m: the sides drive 0.75 pi and 1.25 pi metres.
  OdometrySample sample;
  for (int i = 1; i <= 50; ++i)
    sample = odometer.update(i * 0.02, 1.0 + 7.5 * kPi * i / 50.0, 2.0 + 12.5 * kPi * i / 50.0);
  EXPECT_NEAR(sample.x_m, 0.0, 1e-12);
  EXPECT_NEAR(sample.y_m, 2.0, 1e-12);
  EXPECT_NEAR(std::abs(sample.yaw_rad), kPi, 1e-12);
  EXPECT_EQ(sample.stamp_s, 1.0);
}

TEST(WheelOdometer, CountsWholeTicksAndLosesNone) {
  const WheelGeometry wheels{0.1, 0.5, 100.0};
  const double tick_m = 2.0 * kPi * 0.1 / 100.0;
  WheelOdometer odometer(wheels, 0.0, 0.0);
  OdometrySample sample;
  for (int i = 1; i <= 1000; ++i) {
    const double angle = 0.013 * i;  // never a whole number of ticks
    sample = odometer.update(i, angle, angle);
    const double ticks = sample.x_m / tick_m;
    ASSERT_NEAR(ticks, std::round(ticks), 1e-6);
    ASSERT_LE(std::abs(sample.x_m - 0.1 * angle), tick_m);
  }
  EXPECT_EQ(sample.yaw_rad, 0.0);
}

TEST(RobotTrajectory, InterpolatesOnTheArcAndStandsBeforeAndAfter) {
  Vector6d twist;
  twist << 0.5, 0.0, 0.01, 0.02, -0.03, 0.8;
  RobotTrajectory trajectory;
  for (int i = 0; i <= 10; ++i) trajectory.add(0.1 * i, se3_exp(0.1 * i * twist));
  const Vector6d expected = se3_log(trajectory.at(0.537));
  EXPECT_LT((expected - 0.537 * twist).norm(), 1e-12);
  EXPECT_LT((trajectory.at(7.0).translation - se3_exp(twist).translation).norm(), 1e-12);
  EXPECT_LT(trajectory.at(-1.0).translation.norm(), 1e-12);
  const std::vector<Rigid3> exposure = trajectory.during(0.5, 0.04, 4);
  ASSERT_EQ(exposure.size(), 4U);
  EXPECT_LT((se3_log(exposure.front()) - 0.485 * twist).norm(), 1e-12);
  EXPECT_LT((se3_log(exposure.back()) - 0.515 * twist).norm(), 1e-12);
}

TEST(RobotTrajectory, BendsAsTheRobotSpeedsUp) {
  constexpr double kTurn_rad_s2 = 3.0, kAlong_m_s2 = 1.0;
  RobotTrajectory trajectory;
  const auto pose = [&](double t) { return planar_pose(0.5 * kAlong_m_s2 * t * t, 0.0, 0.5 * kTurn_rad_s2 * t * t); };
  for (int i = 0; i <= 30; ++i) trajectory.add(0.01 * i, pose(0.01 * i));
  for (const double t : {0.2, 0.2025, 0.205, 0.2075}) {
    const Vector6d off = se3_log(pose(t).inverse() * trajectory.at(t));
    EXPECT_LT(off.tail<3>().norm(), 1e-12) << t;
    EXPECT_LT(off.head<3>().norm(), 2e-7) << t << ": robots that turn drive aside";
  }
}

TEST(RobotTrajectory, ForgetsWhatWasTakenBack) {
  RobotTrajectory trajectory;
  for (int i = 0; i <= 10; ++i) trajectory.add(i, planar_pose(i, 0.0, 0.0));
  trajectory.cut_after(4.5);
  EXPECT_EQ(trajectory.end_s(), 4.0);
  EXPECT_NEAR(trajectory.length_m(), 4.0, 1e-12);
  trajectory.add(4.5, planar_pose(9.0, 0.0, 0.0));
  EXPECT_THROW(trajectory.add(4.5, Rigid3()), std::exception);
}

}  // namespace
}  // namespace rigproof
