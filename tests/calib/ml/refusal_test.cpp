#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration_truth.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"
#include "worded.h"

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
    EXPECT_NE(worded(result.reasons).front().find(c.words), std::string::npos) << worded(result.reasons).front();
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

// Two planes agree by chance far better than they are: eight of two hundred such runs stated a tenth of the error.
TEST(Refusal, HeightAndTiltThatStandAfterTwoStopsAreNoSurerThanTheyShouldBe) {
  constexpr double kSigmas = 6.0, kRounding = 2e-5;
  for (const int seed : {3, 10, 11, 14, 48, 160, 161, 170}) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(seed);
    config.rig = random_rig(config.seed, 1 + seed % 4);
    config.stops = 2;
    config.lambda = (seed / 2) % 2;
    config.declare_odometry_model = config.declare_odometry_sigmas = seed % 2 == 0;
    const GeometricRun run = draw_geometric_run(config);
    const Result result = estimate_maximum_likelihood(run.observations).result;
    for (const EstimatedTransform& stated : result.camera_to_robot) {
      EstimatedTransform truth = stated;
      for (const TrueCamera& camera : run.truth.cameras)
        if (camera.name == stated.child) truth.T_parent_child = camera.T_robot_camera;
      const EstimatedTransform estimate = heading_free(stated);
      const Vector6d error = transform_error(estimate.T_parent_child, heading_free(truth).T_parent_child).cwiseAbs();
      for (const int axis : {2, 3, 4}) {
        if (!stated.observable[static_cast<std::size_t>(axis)]) continue;
        EXPECT_LT(error[axis], kRounding + kSigmas * std::sqrt(estimate.covariance.value()(axis, axis)))
            << "seed " << seed << ", " << stated.child << ", axis " << axis;
      }
    }
  }
}

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

// Error of every value that stands, over its stated standard deviation: the largest.
double worst_of_what_stands(const Result& result, const Truth& truth) {
  double worst = 0.0;
  for (const EstimatedTransform& transform : result.camera_to_robot) {
    for (const TrueCamera& camera : truth.cameras) {
      if (camera.name != transform.child) continue;
      const Vector6d error = transform_error(transform.T_parent_child, camera.T_robot_camera);
      for (int axis = 0; axis < 6; ++axis)
        if (transform.observable[static_cast<std::size_t>(axis)])
          worst = std::max(worst, std::abs(error[axis]) / std::sqrt((*transform.covariance)(axis, axis)));
    }
  }
  return worst;
}

// Three metres from a board of 0.3 m a view is turned by degrees and its camera as far up or down: the ground planes,
// which are sure, must still give the vertical. From another start the solution is metres off, or blames the odometry.
TEST(Refusal, FarViewsHideNoVerticalAndBlameNobody) {
  for (const GeometricDrive drive : {GeometricDrive::kSteps, GeometricDrive::kTurnInPlace, GeometricDrive::kArc}) {
    for (const std::uint64_t seed : {4U, 11U, 38U}) {
      for (const int stops : {5, 8}) {
        GeometricConfig config;
        config.seed = seed;
        config.drive = drive;
        config.stops = stops;
        const GeometricRun run = draw_geometric_run(config);
        const Result result = estimate_maximum_likelihood(run.observations).result;
        SCOPED_TRACE("drive " + std::to_string(static_cast<int>(drive)) + ", seed " + std::to_string(seed) + ", " +
                     std::to_string(stops) + " stops");
        for (const std::string& reason : worded(result.reasons)) {
          EXPECT_EQ(reason.find("cause"), std::string::npos) << reason;
          EXPECT_EQ(reason.find("odometry"), std::string::npos) << reason;
        }
        EXPECT_LT(worst_of_what_stands(result, run.truth), 6.0);
      }
    }
  }
}

// A wild row also predicts its own stop wrongly, and chance puts there what another camera would see.
TEST(Refusal, WildRowsAreNoSwappedFrames) {
  for (const std::uint64_t seed : {13U, 23U, 29U}) {
    GeometricConfig config;
    config.seed = seed;
    config.stops = 100;
    config.lambda = 0.0;
    config.odometry_model = OdometryModel::kPerPose;
    config.corner_outlier_fraction = 0.02;
    config.odometry_outlier_fraction = config.plane_outlier_fraction = 0.05;
    MlOptions options;
    options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
    options.estimate_corner_level = options.estimate_plane_level = false;
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations, options).result;
    EXPECT_EQ(result.status, ResultStatus::kSolved)
        << "seed " << seed << ": " << (result.reasons.empty() ? "" : worded(result.reasons).front());
  }
}

// Exact corners and planes beside odometry that five stops do not judge: seven orders of magnitude in one equation.
TEST(Refusal, ExactDataAreSolved) {
  for (const OdometryModel model : {OdometryModel::kPerIncrement, OdometryModel::kPerPose}) {
    for (const bool declared : {true, false}) {
      GeometricConfig config;
      config.stops = 5;
      config.corner_sigma_px = config.inverse_depth_sigma_per_m = config.lambda = 0.0;
      config.odometry_model = model;
      config.declare_odometry_model = config.declare_odometry_sigmas = declared;
      const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
      EXPECT_EQ(result.status, ResultStatus::kSolved)
          << odometry_model_name(model) << ": "
          << (result.reasons.empty() ? "no reason" : worded(result.reasons).front());
    }
  }
}

// Five stops of four cameras that share no view do not tell one odometry model from the other, and the likelier one may
// be wrong: what the other one says must be part of the stated uncertainty.
TEST(Refusal, AnUndecidedOdometryModelIsPartOfTheUncertainty) {
  for (const std::uint64_t seed : {3U, 7U, 15U}) {
    GeometricConfig config;
    config.seed = seed;
    config.rig = random_rig(seed, 4);
    config.stops = 5;
    config.declare_odometry_model = config.declare_odometry_sigmas = false;
    const GeometricRun run = draw_geometric_run(config);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
    EXPECT_LT(estimate.odometry.probability, 0.999) << seed;
    EXPECT_LT(worst_of_what_stands(estimate.result, run.truth), 6.0) << seed;
  }
}

TEST(Refusal, HealthyDrivesAreNotOverTrials) {
  for (int seed = 0; seed < Trials(16, 60).count(); ++seed) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(seed);
    config.stops = 5 + seed % 4 * 5;
    config.lambda = seed % 2 == 0 ? 0.0 : 1.0;
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
    EXPECT_EQ(result.status, ResultStatus::kSolved)
        << "seed " << seed << ": " << (result.reasons.empty() ? "" : worded(result.reasons).front());
  }
}

// Of a rotation between cameras no angle of a file belongs to an axis of its uncertainty.
TEST(Refusal, RotationsBetweenCamerasAreToldWholeOrNot) {
  int open = 0;
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    GeometricConfig config;
    config.seed = seed;
    config.rig = random_rig(seed, 3);
    config.stops = 6;
    config.corner_sigma_px = 0.7 + 0.3 * static_cast<double>(seed % 4);
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
    for (const EstimatedTransform& pair : result.camera_to_camera) {
      const auto told = std::count(pair.observable.begin() + 3, pair.observable.end(), true);
      EXPECT_TRUE(told == 0 || told == 3) << pair.parent << " " << pair.child << " " << told;
      open += told == 0;
    }
  }
  EXPECT_GT(open, 0);
}

bool mentions(const Result& result, const std::string& words) {
  for (const std::string& reason : worded(result.reasons))
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
