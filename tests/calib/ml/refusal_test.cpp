#include <gtest/gtest.h>

#include "calibration_truth.h"
#include "pose_near.h"
#include "rigproof/calib/ml.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

struct Case {
  const char* name;
  GeometricDrive drive;
  int stops;
  bool ground;
  const char* words;            ///< that the reason must contain
  std::array<bool, 6> unknown;  ///< degrees that must be refused
};

std::ostream& operator<<(std::ostream& stream, const Case& c) { return stream << c.name; }

constexpr std::array<bool, 6> kPlanar = {true, true, false, false, false, true};

class Degenerate : public testing::TestWithParam<Case> {};

TEST_P(Degenerate, IsRefusedWithTheReasonAndKeepsWhatHolds) {
  const Case& c = GetParam();
  for (int i = 0; i < 12; ++i) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(i);
    config.rig = random_rig(config.seed, 1 + i % 4);
    config.drive = c.drive;
    config.stops = c.stops;
    config.ground = c.ground;
    config.declare_odometry_sigmas = i % 2 == 0;
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
    SCOPED_TRACE("seed " + std::to_string(i));
    EXPECT_NE(result.status, ResultStatus::kSolved);
    EXPECT_FALSE(result.joint_covariance.has_value());
    ASSERT_FALSE(result.reasons.empty());
    EXPECT_NE(result.reasons.front().find(c.words), std::string::npos) << result.reasons.front();
    for (const EstimatedTransform& transform : result.camera_to_robot)
      for (std::size_t axis = 0; axis < 6; ++axis)
        EXPECT_FALSE(c.unknown[axis] && transform.observable[axis]) << transform.child << " axis " << axis;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Drives, Degenerate,
    testing::Values(
        Case{"straight", GeometricDrive::kStraight, 15, true, "straight", {true, true, false, false, false, false}},
        Case{"turn", GeometricDrive::kTurnInPlace, 15, true, "turned in place", kPlanar},
        Case{"arc", GeometricDrive::kArc, 15, true, "one centre", kPlanar},
        Case{"standstill", GeometricDrive::kStandstill, 15, true, "stood still", kPlanar},
        Case{"one", GeometricDrive::kRandom, 1, true, "1 usable pose", kPlanar},
        Case{"two", GeometricDrive::kRandom, 2, true, "usable pose", kPlanar},
        Case{"no_ground", GeometricDrive::kRandom, 20, false, "no ground", {false, false, true, false, false, false}}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(Refusal, CameraToCameraStays) {
  GeometricConfig config;
  config.drive = GeometricDrive::kTurnInPlace;
  config.rig.min_cameras_per_stop = 2;
  config.stops = 20;
  const GeometricRun run = draw_geometric_run(config);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
  EXPECT_EQ(estimate.result.status, ResultStatus::kPartial);
  for (const EstimatedTransform& pair : estimate.result.camera_to_camera) {
    EXPECT_TRUE(pair.fully_observable()) << pair.parent << " " << pair.child;
    const auto camera = [&](const std::string& name) -> const Rigid3& {
      for (const TrueCamera& c : run.truth.cameras)
        if (c.name == name) return c.T_robot_camera;
      throw std::runtime_error("no camera " + name);
    };
    // 5 sigma of its own statement.
    const Vector6d error = transform_error(pair.T_parent_child, camera(pair.parent).inverse() * camera(pair.child));
    EXPECT_LT(error.cwiseQuotient(pair.covariance->diagonal().cwiseSqrt()).cwiseAbs().maxCoeff(), 5.0);
  }
}

TEST(Refusal, HealthyDrivesAreNot) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    GeometricConfig config;
    config.seed = seed;
    config.stops = 5 + static_cast<int>(seed % 4) * 5;
    config.lambda = seed % 2 == 0 ? 0.0 : 1.0;
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
    EXPECT_EQ(result.status, ResultStatus::kSolved)
        << "seed " << seed << ": " << (result.reasons.empty() ? "" : result.reasons.front());
  }
}

bool mentions(const Result& result, const std::string& words) {
  for (const std::string& reason : result.reasons)
    if (reason.find(words) != std::string::npos) return true;
  return false;
}

// Data that contradict each other, with and without declared noise.
class Contradictory : public testing::TestWithParam<bool> {
 protected:
  Contradictory() {
    GeometricConfig config;
    config.stops = 15;
    config.declare_odometry_model = config.declare_odometry_sigmas = GetParam();
    observations = draw_geometric_run(config).observations;
  }
  void expect_unusable(const std::string& words) const {
    const Result result = estimate_maximum_likelihood(observations).result;
    EXPECT_NE(result.status, ResultStatus::kSolved);
    EXPECT_TRUE(mentions(result, words)) << testing::PrintToString(result.reasons);
    for (const EstimatedTransform& transform : result.camera_to_robot) EXPECT_FALSE(transform.observable[0]);
  }
  Observations observations;
};

TEST_P(Contradictory, OdometryInMillimetres) {
  for (Stop& stop : observations.stops) {
    stop.x_m *= 1000.0;
    stop.y_m *= 1000.0;
  }
  expect_unusable("odometry");
}

TEST_P(Contradictory, OdometryMirrored) {
  for (Stop& stop : observations.stops) {
    stop.y_m = -stop.y_m;
    stop.yaw_rad = -stop.yaw_rad;
  }
  expect_unusable("odometry");
}

TEST_P(Contradictory, StampsShiftedByOneStop) {
  for (std::size_t i = 0; i + 1 < observations.stops.size(); ++i) observations.stops[i] = observations.stops[i + 1];
  expect_unusable("odometry");
}

TEST_P(Contradictory, IntrinsicsOfAnotherCamera) {
  observations.cameras[1].camera.fx_px *= 1.3;
  observations.cameras[1].camera.cx_px += 60.0;
  const Result result = estimate_maximum_likelihood(observations).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
}

INSTANTIATE_TEST_SUITE_P(Declared, Contradictory, testing::Bool());

TEST(Refusal, NoBoardAtAllIsSaid) {
  GeometricConfig config;
  config.stops = 5;
  GeometricRun run = draw_geometric_run(config);
  run.observations.board_views.clear();
  const Result result = estimate_maximum_likelihood(run.observations).result;
  EXPECT_EQ(result.status, ResultStatus::kRefused);
  EXPECT_TRUE(result.camera_to_robot.empty());
  ASSERT_FALSE(result.reasons.empty());
}

TEST(Refusal, EmptyObservationsAreNotAnError) {
  EXPECT_EQ(estimate_maximum_likelihood(Observations()).result.status, ResultStatus::kRefused);
}

}  // namespace
}  // namespace rigproof
