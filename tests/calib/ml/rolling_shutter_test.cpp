// Images of a rolling shutter, taken while the robot moves: rows show the board from where the robot is when they are
// read, and the robot moves otherwise than its odometry says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "row_motion.h"
#include "trials.h"

namespace rigproof {
namespace {

const Trials kTrials(10, 100);
constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES
constexpr double kNoChance = 60.0;
constexpr double kReadoutSigma_s = 0.015;

struct RollingRun {
  GeometricRun run;
  std::vector<double> readout_s;  // of each camera
};

// Of the robot along its own axes (v, omega), beside what its odometry says (docs/theory/estimation.md).
Vector6d velocity_error(double turn_rate_rad_s, RandomStream* random) {
  const double along = std::hypot(1e-3, 8e-3 * turn_rate_rad_s), turn = std::hypot(1e-3, 0.05 * turn_rate_rad_s);
  Vector6d error;
  for (const auto& [axis, sigma] : {std::pair(0, along), {1, along}, {2, 2e-3}, {3, 5e-3}, {4, 5e-3}, {5, turn}})
    error[axis] = random->normal(0.0, sigma);
  return error;
}

// Along the robot's own axes (v, omega), how it changes, and by how much a view lies aside as a whole: an image is the
// mean of its exposure, in which the body swings.
struct TrueMotion {
  Vector6d velocity, acceleration, displaced = Vector6d::Zero();
};

Vector6d displacement_of(RandomStream* random) {
  Vector6d displaced;
  for (int axis = 0; axis < 6; ++axis) displaced[axis] = random->normal(0.0, axis < 3 ? 5e-6 : 1.5e-5);
  return displaced;
}

Vector6d acceleration_of(RandomStream* random) {
  Vector6d acceleration;
  for (int axis = 0; axis < 6; ++axis) acceleration[axis] = random->normal(0.0, axis < 3 ? 0.3 : 1.8);
  return acceleration;
}

// By how much a corner lies elsewhere than where the robot is when the middle row is read. se3 has (v, omega).
Eigen::Vector2d shift_of_row(const TrueCamera& camera, const Rigid3& T_world_robot, const TrueMotion& motion,
                             const Eigen::Vector3d& corner_world, double readout_s) {
  const auto seen_at = [&](double t) {
    const Vector6d way = t * motion.velocity + 0.5 * t * t * motion.acceleration;
    const Rigid3 T_world_camera = T_world_robot * se3_exp(motion.displaced) * se3_exp(way) * camera.T_robot_camera;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    EXPECT_TRUE(camera.camera.project(T_world_camera.inverse() * corner_world, &pixel));
    return pixel;
  };
  Eigen::Vector2d middle, pixel = seen_at(0.0);
  EXPECT_TRUE(camera.camera.project((T_world_robot * camera.T_robot_camera).inverse() * corner_world, &middle));
  for (int round = 0; round < 8; ++round)
    pixel = seen_at(readout_s * ((pixel.y() + 0.5) / camera.camera.height_px - 0.5));
  return pixel - middle;
}

// All cameras of a stop share the error of its motion, though the estimator gives each view one of its own.
RollingRun rolling_run(int seed, bool moving = true, double worse = 1.0) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  RollingRun made{draw_geometric_run(config), {}};
  RandomStream random(config.seed, "rolling shutter");
  for (std::size_t c = 0; c < made.run.truth.cameras.size(); ++c)
    made.readout_s.push_back(random.normal(0.0, kReadoutSigma_s));
  Observations& observations = made.run.observations;
  for (RigCamera& camera : observations.cameras) camera.readout_sigma_s = kReadoutSigma_s;
  if (!moving) return made;
  std::vector<TrueMotion> motions;
  RandomStream speeding_up(config.seed, "speeding up"), smeared(config.seed, "smeared");
  for (Stop& stop : observations.stops) {
    stop.velocity << random.uniform(-0.8, 0.8), random.uniform(-0.1, 0.1), random.uniform(-0.8, 0.8);
    motions.push_back({worse * velocity_error(stop.velocity.z(), &random), worse * acceleration_of(&speeding_up)});
    motions.back().velocity.head<2>() += stop.velocity.head<2>();
    motions.back().velocity[5] += stop.velocity.z();
  }
  const Truth& truth = made.run.truth;
  for (BoardView& view : observations.board_views) {
    const auto stop = static_cast<std::size_t>(view.stop), camera = static_cast<std::size_t>(view.camera);
    motions[stop].displaced = displacement_of(&smeared);
    for (CornerObservation& corner : view.corners)
      corner.pixel += shift_of_row(truth.cameras[camera], truth.stops[stop].T_world_robot, motions[stop],
                                   truth.T_world_board * observations.board.corner(corner.id), made.readout_s[camera]);
  }
  return made;
}

MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  options.priors.riding_height_m = 0.0;  // none is drawn
  return options;
}

const EstimatedQuantity* readout_of(const Result& result, const std::string& camera) {
  const auto found =
      std::find_if(result.also_estimated.begin(), result.also_estimated.end(),
                   [&](const auto& quantity) { return quantity.camera == camera && quantity.name == "readout_ms"; });
  return found == result.also_estimated.end() ? nullptr : &*found;
}

TEST(MlRollingShutter, IsEstimatedAndTheUncertaintyIsTrueOverTrials) {
  double mean = 0.0, square = 0.0, sigma_ms = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const RollingRun made = rolling_run(seed);
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    EXPECT_TRUE(estimate.converged) << seed;
    mean += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
    for (std::size_t c = 0; c < made.readout_s.size(); ++c) {
      const EstimatedQuantity* readout = readout_of(estimate.result, made.run.truth.cameras[c].name);
      ASSERT_NE(readout, nullptr);
      EXPECT_LT(readout->sigma, 0.1 * readout->prior_sigma);
      sigma_ms += readout->sigma / static_cast<double>(made.readout_s.size()) / kTrials.count();
      const double z = (readout->value - 1e3 * made.readout_s[c]) / readout->sigma;
      square += z * z / static_cast<double>(made.readout_s.size()) / kTrials.count();
    }
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_NEAR(square, 1.0, kTrials.chi_square_tolerance(1));
  EXPECT_LT(sigma_ms, 0.5);
}

// Global shutters, fine corners: all corners of a view lie elsewhere, by as much as their noise but alike.
GeometricRun smeared_run(int seed, double worse = 1.0) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  config.corner_sigma_px = 0.01;
  GeometricRun run = draw_geometric_run(config);
  RandomStream random(config.seed, "smeared");
  for (RigCamera& camera : run.observations.cameras) camera.readout_sigma_s = kReadoutSigma_s;
  for (Stop& stop : run.observations.stops)
    stop.velocity << random.uniform(-0.8, 0.8), random.uniform(-0.1, 0.1), random.uniform(-0.8, 0.8);
  for (BoardView& view : run.observations.board_views) {
    const TrueCamera& camera = run.truth.cameras[static_cast<std::size_t>(view.camera)];
    const Rigid3& T_world_robot = run.truth.stops[static_cast<std::size_t>(view.stop)].T_world_robot;
    const TrueMotion motion{Vector6d::Zero(), Vector6d::Zero(), worse * displacement_of(&random)};
    for (CornerObservation& corner : view.corners)
      corner.pixel += shift_of_row(camera, T_world_robot, motion,
                                   run.truth.T_world_board * run.observations.board.corner(corner.id), 0.0);
  }
  return run;
}

TEST(MlRollingShutter, MeansOfExposuresAreAllowedForOverTrials) {
  double mean = 0.0;
  for (int i = 0; i < kTrials.count(); ++i) {
    const GeometricRun run = smeared_run(i);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_TRUE(estimate.result.joint_covariance) << i;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

// Stamps that are off, cameras that shake: the data say by how much.
TEST(MlRollingShutter, ViewsDisplacedByMoreThanExposuresDoAreAllowedForAndTold) {
  constexpr double kWorse = 60.0, kPartsAView = 6.0;  // a milliradian
  MlOptions options = told();
  options.estimate_corner_level = true;  // which shall not take them for its own
  double mean = 0.0;
  for (int i = 0; i < kTrials.count(); ++i) {
    const GeometricRun run = smeared_run(i, kWorse);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << i;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
    const double least_redundancy = kPartsAView * static_cast<double>(run.observations.stops.size());
    EXPECT_NEAR(std::log(estimate.displacement_scale / kWorse), 0.0, 4.0 / std::sqrt(2.0 * least_redundancy)) << i;
    EXPECT_TRUE(has_code(estimate.result.notes, "images.displaced")) << i;
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

// Of coarse corners that tell nothing of displacements they are at their least, not where the search for them begins.
TEST(MlRollingShutter, DisplacementsThatDoNotShowAreTheLeast) {
  GeometricRun run = smeared_run(0);
  for (BoardView& view : run.observations.board_views)
    for (CornerObservation& corner : view.corners) corner.covariance_px2 = 400.0 * Eigen::Matrix2d::Identity();
  const MlOptions options = told();  // of which the preparation keeps a reference
  const ml::Preparation prepared = ml::prepare(run.observations, options);
  EXPECT_EQ(ml::choose_odometry(prepared).fit.noise.displacement_scale, 1.0);
}

TEST(MlRollingShutter, ViewsDisplacedAsByExposuresRaiseNoSuspicion) {
  for (int i = 0; i < kTrials.count(); ++i) {
    const MlEstimate estimate = estimate_maximum_likelihood(smeared_run(i).observations, told());
    EXPECT_LT(estimate.displacement_scale, 1.5) << i;
    EXPECT_FALSE(has_code(estimate.result.notes, "images.displaced")) << i;
  }
}

ml::RowMotion speeding_motion(const Rigid3& T_robot_camera) {
  ml::RowMotion motion = ml::row_motion(T_robot_camera, {0.6, 0.05, 0.7}, 1.0, 1.0, 1.0);
  motion.readout_s = 0.03;
  motion.rows = 720;
  ml::MotionVector error = ml::MotionVector::Zero();
  error << 1.0, -0.6, 0.8, -1.2, 0.7, 0.5, 0.3, -0.2, 0.5, 1.0, -0.7, 0.4, 0.8, -0.6, 0.9, 1.2, -0.8, 1.1;
  motion.set_error(error);
  return motion;
}

// Where a point of the camera lies a time later, by many small steps along its twist, which changes evenly.
Eigen::Vector3d carried(const ml::RowMotion& motion, Eigen::Vector3d point, double time_s) {
  constexpr int kSteps = 4000;
  point += motion.twist.head<3>().cross(point) + motion.twist.segment<3>(3);
  for (int i = 0; i < kSteps; ++i) {
    const Vector6d twist = motion.twist.segment<6>(6) + (i + 0.5) / kSteps * time_s * motion.twist.tail<6>();
    point += time_s / kSteps * (twist.head<3>().cross(point) + twist.tail<3>());
  }
  return point;
}

TEST(MlRollingShutter, RowsShowWhatARobotThatSpeedsUpCarriesAlong) {
  const Rigid3 T_robot_camera = GeometricConfig().rig.T_robot_camera[0];
  const ml::RowMotion motion = speeding_motion(T_robot_camera);
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  const Eigen::Vector3d corner(0.4, -0.5, 2.0);
  for (const double row : {0.0, 200.0, 359.5, 719.0}) {
    const double time_s = motion.readout_s * motion.share(row);
    const Eigen::Vector2d measured(500.0, row);
    ml::RowResidual residual;
    ASSERT_TRUE(ml::row_residual(camera, motion, corner, measured, &residual));
    // The third power of time is left out: .003 px.
    EXPECT_LT((residual.point_camera - carried(motion, corner, time_s)).norm(), 1e-5) << row;
  }
}

TEST(MlRollingShutter, DerivativesByTheMotionAndItsChangeAreThoseOfTheResidual) {
  const Rigid3 T_robot_camera = GeometricConfig().rig.T_robot_camera[0];
  const ml::RowMotion motion = speeding_motion(T_robot_camera);
  const Camera camera = Camera::symmetric(1280, 720, 640.0);
  const Eigen::Vector3d corner(0.4, -0.5, 2.0);
  const Eigen::Vector2d measured(500.0, 30.0);
  const auto value_at = [&](const ml::RowMotion& moved) {
    ml::RowResidual residual;
    EXPECT_TRUE(ml::row_residual(camera, moved, corner, measured, &residual));
    return residual;
  };
  const ml::RowResidual residual = value_at(motion);
  const double step = 1e-4;
  for (int i = 0; i < ml::kMotion; ++i) {
    ml::RowMotion more = motion, less = motion;
    more.twist[i] += step;
    less.twist[i] -= step;
    const Eigen::Vector2d slope = (value_at(more).value - value_at(less).value) / (2.0 * step);
    EXPECT_LT((residual.by_motion.col(i) - slope).norm(), 1e-6 * slope.norm() + 1e-9) << i;
  }
  ml::RowMotion longer = motion, shorter = motion;
  longer.readout_s += step;
  shorter.readout_s -= step;
  const Eigen::Vector2d slope = (value_at(longer).value - value_at(shorter).value) / (2.0 * step);
  EXPECT_LT((residual.by_readout - slope).norm(), 1e-3 * slope.norm());
}

TEST(MlRollingShutter, ThatIsTakenForAGlobalOneShows) {
  RollingRun made = rolling_run(0);
  for (RigCamera& camera : made.run.observations.cameras) camera.readout_sigma_s = 0.0;
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
  EXPECT_TRUE(!estimate.result.joint_covariance || nees(estimate, poses_of(made.run.truth)) > kNoChance);
}

// Twenty times further from its odometry than any robot that was seen. Nine of ten such runs are refused; one that is
// answered is suspected, and not far off.
TEST(MlRollingShutter, MotionFarFromItsOdometryIsNotSilentlyWrong) {
  const RollingRun made = rolling_run(5, true, 20.0);
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations);
  ASSERT_TRUE(estimate.result.joint_covariance);
  const std::vector<Finding>& notes = estimate.result.notes;
  EXPECT_TRUE(
      std::any_of(notes.begin(), notes.end(), [](const Finding& note) { return note.severity == Severity::kSuspect; }));
  EXPECT_LT(nees(estimate, poses_of(made.run.truth)), kNoChance);
}

TEST(MlRollingShutter, ThatIsStatedIsNoUnknown) {
  RollingRun made = rolling_run(1);
  for (std::size_t c = 0; c < made.readout_s.size(); ++c) {
    made.run.observations.cameras[c].readout_s = made.readout_s[c];
    made.run.observations.cameras[c].readout_sigma_s = 0.0;
  }
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
  ASSERT_TRUE(estimate.result.joint_covariance);
  EXPECT_LT(nees(estimate, poses_of(made.run.truth)), kNoChance);
  for (const TrueCamera& camera : made.run.truth.cameras) EXPECT_EQ(readout_of(estimate.result, camera.name), nullptr);
}

TEST(MlRollingShutter, OfARobotThatStandsDoesNotMatter) {
  const RollingRun made = rolling_run(2, false);
  Observations believed = made.run.observations;
  for (RigCamera& camera : believed.cameras) camera.readout_sigma_s = 0.0;
  const MlEstimate doubting = estimate_maximum_likelihood(made.run.observations, told());
  const MlEstimate believing = estimate_maximum_likelihood(believed, told());
  ASSERT_TRUE(doubting.result.joint_covariance && believing.result.joint_covariance);
  EXPECT_EQ(*doubting.result.joint_covariance, *believing.result.joint_covariance);
}

}  // namespace
}  // namespace rigproof
