#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "calibration_truth.h"
#include "pose_near.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

// The levels that were drawn from are told, so that information and covariance match the data.
MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

GeometricConfig noise_free(GeometricConfig config) {
  config.corner_sigma_px = 0.0;
  config.inverse_depth_sigma_per_m = 0.0;
  config.lambda = 0.0;
  return config;
}

void expect_exact(const GeometricRun& run, const MlEstimate& estimate, double tolerance) {
  ASSERT_EQ(estimate.state.T_robot_camera.size(), run.truth.cameras.size());
  for (std::size_t c = 0; c < run.truth.cameras.size(); ++c)
    EXPECT_TRUE(IsPoseNear(run.truth.cameras[c].T_robot_camera, estimate.state.T_robot_camera[c], tolerance, tolerance))
        << "camera " << c;
}

// Exact data leave only rounding. The normal equations square it: they keep half of a double's digits, 1.5e-8.
constexpr double kRounding = 1e-8;

constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES
const Trials kManyTrials(30, 150), kTrials(15, 60);

double mean_nees(GeometricConfig config, const MlOptions& options, const Trials& trials) {
  double sum = 0.0;
  for (int trial = 0; trial < trials.count(); ++trial) {
    config.seed = static_cast<std::uint64_t>(1000 + trial);
    const GeometricRun run = draw_geometric_run(config);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    EXPECT_EQ(estimate.result.status, ResultStatus::kSolved) << "seed " << config.seed;
    if (estimate.result.joint_covariance) sum += nees(estimate, poses_of(run.truth)) / trials.count();
  }
  return sum;
}

TEST(MlRecovery, IsExactWithoutNoise) {
  GeometricConfig config = noise_free({});
  config.stops = 12;
  const GeometricRun run = draw_geometric_run(config);
  expect_exact(run, estimate_maximum_likelihood(run.observations, told()), kRounding);
}

TEST(MlRecovery, IsExactForEveryMountingAndBoardOverTrials) {
  for (int i = 0; i < Trials(16, 40).count(); ++i) {
    GeometricConfig config = noise_free({});
    config.seed = static_cast<std::uint64_t>(i);
    config.rig = random_rig(config.seed, 1 + i % 8);
    config.stops = 24;
    const GeometricRun run = draw_geometric_run(config);
    SCOPED_TRACE(i);
    expect_exact(run, estimate_maximum_likelihood(run.observations, told()), kRounding);
  }
}

TEST(MlRecovery, FindsSystematicErrorsSuspensionAndDepthScale) {
  GeometricConfig config = noise_free({});
  config.odometry_scale = 1.02;
  config.odometry_yaw_factor = 1.05;
  config.suspension_height_sigma_m = 0.001;
  config.suspension_tilt_sigma_rad = 0.001;
  config.stops = 40;
  MlOptions options = told();
  options.suspension_height_sigma_m = config.suspension_height_sigma_m;
  options.suspension_tilt_sigma_rad = config.suspension_tilt_sigma_rad;
  const GeometricRun run = draw_geometric_run(config);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
  // The slack's mean is not zero in a sample of 40: it shifts height and tilt by sigma / sqrt(40).
  expect_exact(run, estimate, 4.0 * 0.001 / std::sqrt(40.0));
  EXPECT_NEAR(estimate.state.odometry_scale, 1.02, 1e-4);
  EXPECT_NEAR(estimate.state.odometry_yaw_factor, 1.05, 1e-4);
}

TEST(MlRecovery, CalibratesTheDepthScaleOnTheBoard) {
  GeometricConfig config;
  config.depth_scale_sigma = 0.01;
  config.board_planes = true;
  config.stops = 60;
  const GeometricRun run = draw_geometric_run(config);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  // 60 boards of 60 points at sigma 0.0025/m and 2 m: 0.0025 * 2 / sqrt(3600) = 8e-5, four times that.
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(estimate.state.depth_scale[c], *run.truth.cameras[c].depth_scale, 4e-4);
}

void expect_true_nees(const GeometricConfig& config, const MlOptions& options) {
  EXPECT_NEAR(mean_nees(config, options, kManyTrials), kUnknowns, kManyTrials.chi_square_tolerance(kUnknowns));
}

TEST(MlUncertainty, IsTrueAlongTheWayOverTrials) {
  GeometricConfig config;
  config.stops = 15;
  config.along_way = true;
  config.odometry_scale = 1.02;
  config.odometry_yaw_factor = 1.05;
  MlOptions options = told();
  options.along_way = true;
  options.priors.rotation_centre_m = 0.0;  // the drawn robot turns about its origin
  expect_true_nees(config, options);
}

// What a chord cannot tell: with 5 % too much turn the way after a turn is bent.
TEST(MlRecovery, IsExactAlongTheWay) {
  GeometricConfig config = noise_free({});
  config.stops = 12;
  config.along_way = true;
  config.odometry_scale = 1.02;
  config.odometry_yaw_factor = 1.05;
  MlOptions options = told();
  options.along_way = true;
  const GeometricRun run = draw_geometric_run(config);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
  EXPECT_NEAR(estimate.state.odometry_yaw_factor, 1.05, 1e-6);
  expect_exact(run, estimate, 1e-5);  // the priors of 10 % pull by (1e-5 / 0.1)^2
}

// Wheels that slip lose their heading where they turn, two driven wheels wherever they roll.
GeometricConfig losing_heading(double metre_as_turn_rad) {
  GeometricConfig config;
  config.stops = 25;
  config.along_way = true;
  config.metre_as_turn_rad = metre_as_turn_rad;
  config.lambda = metre_as_turn_rad > 1.0 ? 0.3 : 1.0;  // alike on the whole
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  return config;
}

TEST(MlOdometry, TheDataSayHowHeadingIsLost) {
  for (const double metre_as_turn_rad : {0.01, 1.0, 10.0}) {
    int near = 0;
    for (int seed = 0; seed < 10; ++seed) {
      GeometricConfig config = losing_heading(metre_as_turn_rad);
      config.seed = static_cast<std::uint64_t>(seed);
      const MlEstimate estimate = estimate_maximum_likelihood(draw_geometric_run(config).observations);
      ASSERT_TRUE(estimate.odometry.along_way) << seed;
      const double found = estimate.noise.law.metre_as_turn_rad;
      near += std::abs(std::log10(found / metre_as_turn_rad)) < 1.5 ? 1 : 0;
      const auto note = std::find_if(estimate.result.notes.begin(), estimate.result.notes.end(),
                                     [](const Finding& one) { return one.is("odometry.noise_along_way"); });
      ASSERT_NE(note, estimate.result.notes.end()) << seed;
      EXPECT_DOUBLE_EQ(std::get<double>(note->find("straight_m")->value), 1.0 / found);
    }
    EXPECT_GE(near, 8) << metre_as_turn_rad;
  }
}

// Told as if it were lost in turns, the heading of a cart has sigmas that are too small.
TEST(MlUncertainty, HoldsHoweverHeadingIsLostOverTrials) {
  for (const double metre_as_turn_rad : {0.01, 10.0}) {
    MlOptions options = told();
    options.priors.rotation_centre_m = 0.0;
    const double mean = mean_nees(losing_heading(metre_as_turn_rad), options, kTrials);
    EXPECT_LT(mean, kUnknowns + kTrials.chi_square_tolerance(kUnknowns)) << metre_as_turn_rad;
    EXPECT_GT(mean, 0.8 * kUnknowns) << metre_as_turn_rad;
  }
}

// Six stops hardly tell how heading is lost: what is usual of a drive must not depend on what they seem to say.
TEST(MlOdometry, FewStopsAreAnsweredHoweverHeadingIsLost) {
  for (const double metre_as_turn_rad : {0.1, 10.0})
    for (int seed = 0; seed < 20; ++seed) {
      GeometricConfig config = losing_heading(metre_as_turn_rad);
      config.stops = 6;
      config.seed = static_cast<std::uint64_t>(seed);
      const MlEstimate estimate = estimate_maximum_likelihood(draw_geometric_run(config).observations);
      EXPECT_EQ(estimate.result.status, ResultStatus::kSolved) << metre_as_turn_rad << " " << seed;
    }
}

TEST(MlOdometry, TheWayIsChosenWhereItIsDriven) {
  for (int seed = 0; seed < 10; ++seed) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(seed);
    config.stops = 20;
    config.along_way = true;
    config.odometry_yaw_factor = 0.96;
    config.declare_odometry_model = config.declare_odometry_sigmas = false;
    const GeometricRun run = draw_geometric_run(config);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
    EXPECT_TRUE(estimate.odometry.along_way) << seed;
    EXPECT_EQ(estimate.result.status, ResultStatus::kSolved) << seed;
    EXPECT_NEAR(estimate.state.odometry_yaw_factor, 0.96, 0.02) << seed;
  }
}

TEST(MlUncertainty, IsTruePerIncrementOverTrials) {
  GeometricConfig config;
  config.stops = 15;
  expect_true_nees(config, told());
}

TEST(MlUncertainty, IsTruePerPoseOverTrials) {
  GeometricConfig config;
  config.stops = 15;
  config.odometry_model = OdometryModel::kPerPose;
  expect_true_nees(config, told());
}

// Levels that are estimated, too: a sigma from the 19 increments of a drive makes Student's t of a normal number, whose
// mean square is 19 / 17 of what is stated.
constexpr double kNearlyTrue = kUnknowns * 2.0 / 17.0;

TEST(MlUncertainty, IsNearlyTrueWithEstimatedSigmasOverTrials) {
  GeometricConfig config;
  config.stops = 20;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  config.suspension_height_sigma_m = 0.001;
  config.suspension_tilt_sigma_rad = 0.001;
  EXPECT_NEAR(mean_nees(config, {}, kTrials), kUnknowns, kNearlyTrue + kTrials.chi_square_tolerance(kUnknowns));
}

// The mean NEES where each plane errs as stated, but with the shares of `common` (one a direction of the covariance's
// Cholesky factor) as all others of its camera do.
void expect_nearly_true_with_shared_ground_error(const Eigen::Vector3d& common) {
  GeometricConfig config;
  config.stops = 15;
  MlOptions options = told();
  options.estimate_plane_level = true;
  double mean = 0.0;
  for (int trial = 0; trial < kTrials.count(); ++trial) {
    config.seed = static_cast<std::uint64_t>(trial);
    config.inverse_depth_sigma_per_m = 0.0025;
    GeometricRun run = draw_geometric_run(config);
    config.inverse_depth_sigma_per_m = 0.0;
    const std::vector<PlaneObservation> exact = draw_geometric_run(config).observations.ground_planes;
    RandomStream random(config.seed, "shared ground error");
    const auto draw = [&random] { return Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
    const std::vector<Eigen::Vector3d> shared = {draw(), draw(), draw()};
    for (std::size_t i = 0; i < exact.size(); ++i) {
      PlaneObservation& plane = run.observations.ground_planes[i];
      const Eigen::Matrix3d L = plane.covariance_per_m2.llt().matrixL();
      const Eigen::Vector3d own = (Eigen::Vector3d::Ones() - common.cwiseAbs2()).cwiseSqrt().cwiseProduct(draw());
      plane.inverse_depth_plane = exact[i].inverse_depth_plane +
                                  L * (common.cwiseProduct(shared[static_cast<std::size_t>(plane.camera)]) + own);
    }
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    EXPECT_EQ(estimate.result.status, ResultStatus::kSolved);
    if (common == Eigen::Vector3d::Ones()) {
      EXPECT_LT(estimate.ground_scale[0], 0.2);
    }
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_NEAR(mean, kUnknowns, kNearlyTrue + kTrials.chi_square_tolerance(kUnknowns));
}

// Without noise a level depth camera rounds the same floor the same way from every stop: its planes agree with each
// other and are wrong together. As if every plane erred by itself it would be hundreds.
TEST(MlUncertainty, IsTrueWhereAllGroundPlanesOfACameraShareTheirErrorOverTrials) {
  expect_nearly_true_with_shared_ground_error({1.0, 1.0, 1.0});
}

TEST(MlUncertainty, IsTrueWhereGroundPlanesShareTheirErrorInOneDirectionOnlyOverTrials) {
  expect_nearly_true_with_shared_ground_error({0.0, 0.0, 1.0});
  expect_nearly_true_with_shared_ground_error({1.0, 0.0, 0.0});
}

// Odometry that is far better than the cameras leaves its own level open; the uncertainty must not fall back to the
// nominal level, which is ten times larger here.
TEST(MlUncertainty, OfOdometryFarBetterThanTheCamerasIsNotTheNominalOne) {
  GeometricConfig config;
  config.stops = 40;
  config.lambda = 0.0;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    config.seed = seed;
    const GeometricRun run = draw_geometric_run(config);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
    const InformationBound bound = cramer_rao_bound(run.observations, state_of(run.truth), noise_of(run.truth));
    const Vector6d ratio =
        estimate.result.camera_to_robot[0].covariance->diagonal().cwiseQuotient(bound.camera_to_robot[0].diagonal());
    EXPECT_LT(std::sqrt(ratio.maxCoeff()), 3.0) << "seed " << seed;
    EXPECT_LT(nees(estimate, poses_of(run.truth)), 45.0) << "seed " << seed;  // chi-square, 18 degrees of freedom: 4e-4
  }
}

TEST(MlUncertainty, EqualsTheBoundAtTheOptimumOfExactData) {
  GeometricConfig config = noise_free({});
  config.stops = 15;
  GeometricRun run = draw_geometric_run(config);
  // Exact data, but told to be noisy: the residuals are zero, so only the loss's efficiency differs from the bound.
  run.observations.odometry_noise.sigma_xy_m = run.truth.odometry_noise.sigma_xy_m = 0.002;
  run.observations.odometry_noise.sigma_yaw_rad = run.truth.odometry_noise.sigma_yaw_rad = 0.01;
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  const InformationBound bound = cramer_rao_bound(run.observations, state_of(run.truth), noise_of(run.truth));
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector6d ratio =
        estimate.result.camera_to_robot[c].covariance->diagonal().cwiseQuotient(bound.camera_to_robot[c].diagonal());
    // A zero residual has weight one instead of its expectation: up to 1 / E[w] = 1.4 less variance for planes.
    EXPECT_GT(ratio.minCoeff(), 0.7);
    EXPECT_LT(ratio.maxCoeff(), 1.05);
  }
}

TEST(MlRobustness, WrongCornersOdometryAndPlanesCostLittleOverTrials) {
  GeometricConfig config;
  config.stops = 40;
  config.corner_outlier_fraction = 0.02;
  config.odometry_outlier_fraction = 0.05;
  config.plane_outlier_fraction = 0.05;
  const Trials trials(8, 20);
  double error2 = 0.0, bound2 = 0.0;
  for (int seed = 0; seed < trials.count(); ++seed) {
    config.seed = static_cast<std::uint64_t>(seed);
    const GeometricRun run = draw_geometric_run(config);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << worded(estimate.result.reasons).front();
    const InformationBound bound = cramer_rao_bound(run.observations, state_of(run.truth), noise_of(run.truth));
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector6d error = transform_error(estimate.state.T_robot_camera[c], run.truth.cameras[c].T_robot_camera);
      error2 += error.cwiseQuotient(bound.camera_to_robot[c].diagonal().cwiseSqrt()).squaredNorm();
      bound2 += 6.0;
    }
  }
  // The bound of clean data; least squares is off by 4 to 40 here. 1.3 covers the scatter of 20 trials.
  EXPECT_LT(std::sqrt(error2 / bound2), 1.0 + trials.tolerance(0.3));
}

TEST(MlOdometry, TellsTheTwoNoiseModelsApart) {
  for (const OdometryModel model : {OdometryModel::kPerIncrement, OdometryModel::kPerPose}) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      GeometricConfig config;
      config.seed = seed;
      config.stops = 25;
      config.lambda = 0.5;  // not the level that the estimation starts from
      config.odometry_model = model;
      config.declare_odometry_model = config.declare_odometry_sigmas = false;
      const GeometricRun run = draw_geometric_run(config);
      const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
      EXPECT_TRUE(estimate.odometry.decided_from_data);
      EXPECT_EQ(estimate.odometry.model, model) << "seed " << seed;
      // 24 increments estimate a sigma to 1 / sqrt(2 * 48 / 2) = 14 %; four times that.
      EXPECT_NEAR(estimate.noise.odometry_xy_m, 0.001, 0.0006);
      EXPECT_NEAR(estimate.noise.odometry_yaw_rad, 0.005, 0.003);
    }
  }
}

// With so few stops nobody can tell: then the wrong one is chosen as often as is stated, whichever it is.
TEST(MlOdometry, ItsModelIsAsProbableAsStatedOverTrials) {
  const int count = Trials(60, 150).count();
  for (const OdometryModel model : {OdometryModel::kPerIncrement, OdometryModel::kPerPose}) {
    double wrong = 0.0, expected = 0.0;
    for (int seed = 0; seed < count; ++seed) {
      GeometricConfig config;
      config.seed = static_cast<std::uint64_t>(seed);
      config.stops = 5;
      config.odometry_model = model;
      config.declare_odometry_model = config.declare_odometry_sigmas = false;
      const OdometryDecision decision = estimate_maximum_likelihood(draw_geometric_run(config).observations).odometry;
      wrong += decision.model != model;
      expected += 1.0 - decision.probability;
    }
    // How far wheels are off is not drawn here, and the levels are estimated: a factor of two beside chance.
    EXPECT_LT(wrong, 2.0 * expected + 4.0 * std::sqrt(expected)) << odometry_model_name(model);
    EXPECT_GT(wrong + 4.0 * std::sqrt(expected), 0.5 * expected) << odometry_model_name(model);
  }
}

// Without ground all cameras may sit higher: that is open in both models alike, and decides nothing between them.
TEST(MlOdometry, TellsTheTwoNoiseModelsApartWithoutGround) {
  for (const OdometryModel model : {OdometryModel::kPerIncrement, OdometryModel::kPerPose}) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      GeometricConfig config;
      config.seed = seed;
      config.stops = 25;
      config.odometry_model = model;
      config.declare_odometry_model = config.declare_odometry_sigmas = false;
      GeometricRun run = draw_geometric_run(config);
      const OdometryDecision with_ground = estimate_maximum_likelihood(run.observations).odometry;
      run.observations.ground_planes.clear();
      run.observations.board_planes.clear();
      const MlEstimate estimate = estimate_maximum_likelihood(run.observations);
      EXPECT_FALSE(estimate.result.camera_to_robot[0].observable[2]);
      EXPECT_TRUE(estimate.odometry.compared);
      EXPECT_EQ(estimate.odometry.model, model) << "seed " << seed;
      // Planes know the tilt, and so a little of a planar drive: not a tenth of what odometry and corners tell.
      EXPECT_GT(with_ground.log_likelihood_ratio, 10.0);
      EXPECT_NEAR(estimate.odometry.log_likelihood_ratio / with_ground.log_likelihood_ratio, 1.0, 0.1)
          << "seed " << seed;
    }
  }
}

// One stop has no increment, and its pose is the world's origin.
TEST(MlOdometry, OneStopPrefersNoModel) {
  GeometricConfig config;
  config.stops = 1;
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  const OdometryDecision decision = estimate_maximum_likelihood(draw_geometric_run(config).observations).odometry;
  EXPECT_TRUE(decision.decided_from_data);
  EXPECT_LT(decision.probability, 0.75);
}

// Cameras back to back never share a view: the odometry links them.
TEST(MlRig, CamerasWithoutOverlapAreLinkedByOdometry) {
  GeometricConfig config;
  config.rig = random_rig(11, 3);
  config.stops = 45;
  config.lambda = 0.2;
  const GeometricRun run = draw_geometric_run(config);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  EXPECT_EQ(estimate.result.camera_to_camera.size(), 3U);
  EXPECT_LT(nees(estimate, poses_of(run.truth)), 45.0);  // chi-square, 18 degrees of freedom: 4e-4
}

TEST(MlRig, ACameraThatSawNothingHasNoPose) {
  GeometricConfig config;
  config.stops = 15;
  GeometricRun run = draw_geometric_run(config);
  std::vector<BoardView>& views = run.observations.board_views;
  views.erase(std::remove_if(views.begin(), views.end(), [](const BoardView& v) { return v.camera == 1; }),
              views.end());
  const Result result = estimate_maximum_likelihood(run.observations, told()).result;
  EXPECT_EQ(result.status, ResultStatus::kPartial);
  EXPECT_EQ(result.camera_to_robot.size(), 2U);
  EXPECT_EQ(result.find("base_footprint", "center"), nullptr);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(worded(result.reasons).back().find("center: it has no pose: the board is in none of its images"),
            std::string::npos);
}

TEST(MlRig, ASwappedViewIsLeftOutAndNamed) {
  GeometricConfig config;
  config.stops = 15;
  GeometricRun run = draw_geometric_run(config);
  std::vector<BoardView>& views = run.observations.board_views;
  std::swap(views[9].corners, views[30].corners);
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  int left_out = 0;
  for (const CameraUse& use : estimate.result.use)
    for (const Exclusion& exclusion : use.left_out) left_out += exclusion.why.is("view.residual") ? 1 : 0;
  EXPECT_EQ(left_out, 2);
  EXPECT_LT(nees(estimate, poses_of(run.truth)), 45.0);
}

// A solution is good to 1e-9 of a standard deviation, which is a centimetre at most; the rest is margin for rounding.
constexpr double kSolved = 1e-9;

// The result must not depend on names and frames that we choose.
struct Equivariance : testing::Test {
  Equivariance() {
    GeometricConfig config;
    config.stops = 20;
    run = draw_geometric_run(config);
    options = told();
    options.tolerance = 1e-18;
    base = estimate_maximum_likelihood(run.observations, options);
  }
  void expect_same(const Observations& observations) const {
    const MlEstimate other = estimate_maximum_likelihood(observations, options);
    for (const EstimatedTransform& expected : base.result.camera_to_robot) {
      const EstimatedTransform* actual = other.result.find(expected.parent, expected.child);
      ASSERT_NE(actual, nullptr);
      EXPECT_TRUE(IsPoseNear(expected.T_parent_child, actual->T_parent_child, kSolved, kSolved)) << expected.child;
    }
  }
  GeometricRun run;
  MlOptions options;
  MlEstimate base;
};

TEST_F(Equivariance, ToTheWorldFrame) {
  Observations moved = run.observations;
  const Rigid3 T_new_old = planar_pose(3.0, -2.0, 2.5);
  for (Stop& stop : moved.stops) {
    const Rigid3 T = T_new_old * planar_pose(stop.x_m, stop.y_m, stop.yaw_rad);
    stop.x_m = T.translation.x();
    stop.y_m = T.translation.y();
    stop.yaw_rad = yaw_of(T);
  }
  expect_same(moved);
}

TEST_F(Equivariance, ToTheBoardFrame) {
  Observations turned = run.observations;
  const int last = turned.board.corner_count() - 1;
  for (BoardView& view : turned.board_views) {
    for (CornerObservation& corner : view.corners) corner.id = last - corner.id;
    std::reverse(view.corners.begin(), view.corners.end());
  }
  expect_same(turned);
}

TEST_F(Equivariance, ToTheOrderOfCameras) {
  Observations shuffled = run.observations;
  const auto renumber = [](int camera) { return (camera + 1) % 3; };
  for (int c = 0; c < 3; ++c)
    shuffled.cameras[static_cast<std::size_t>(renumber(c))] = run.observations.cameras[static_cast<std::size_t>(c)];
  const auto by_stop_and_camera = [](const auto& a, const auto& b) {
    return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
  };
  for (BoardView& view : shuffled.board_views) view.camera = renumber(view.camera);
  for (PlaneObservation& plane : shuffled.ground_planes) plane.camera = renumber(plane.camera);
  std::sort(shuffled.board_views.begin(), shuffled.board_views.end(), by_stop_and_camera);
  std::sort(shuffled.ground_planes.begin(), shuffled.ground_planes.end(), by_stop_and_camera);
  expect_same(shuffled);
}

}  // namespace
}  // namespace rigproof
