// Errors of lenses, clocks and of the point about which the robot turns, drawn from their priors: with the prior told
// the uncertainty is true, and without it the error shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/clock.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/calib/estimate/problem.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

const Trials kTrials(10, 40);
constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES
// A chi-square with 18 degrees of freedom is larger twice in a million runs.
constexpr double kNoChance = 60.0;

MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

double value_of(const Result& result, const std::string& camera, const std::string& name,
                double EstimatedQuantity::*m) {
  for (const EstimatedQuantity& quantity : result.also_estimated)
    if (quantity.camera == camera && quantity.name == name) return quantity.*m;
  ADD_FAILURE() << camera << ": no " << name;
  return 0.0;
}

// Mean square of (estimate - truth) / sigma, where several estimates of a trial count as one.
struct MeanSquare {
  double sum = 0.0;
  int count = 0;
  void add(const Result& result, const std::string& camera, const std::string& name, double truth) {
    const double z = (value_of(result, camera, name, &EstimatedQuantity::value) - truth) /
                     value_of(result, camera, name, &EstimatedQuantity::sigma);
    sum += z * z;
    ++count;
  }
  void expect_one() const { EXPECT_NEAR(sum / count, 1.0, kTrials.chi_square_tolerance(1)); }
};

// Whether a run that is solved as if nothing were wrong is refused, or its error is far beyond what is stated.
bool error_shows(const GeometricRun& run) {
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  EXPECT_TRUE(estimate.result.also_estimated.empty());
  return !estimate.result.joint_covariance || nees(estimate, poses_of(run.truth)) > kNoChance;
}

constexpr double kFocal = 0.003, kPrincipal_px = 1.0, kClock_s = 0.01, kTurnLag_s = 0.02;

// The cameras are other ones than the rig says.
GeometricRun run_with_wrong_lenses(int seed) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  const std::vector<RigCamera> stated = config.rig.cameras;
  RandomStream random(config.seed, "lens errors");
  for (RigCamera& camera : config.rig.cameras) {
    const double factor = 1.0 + random.normal(0.0, kFocal);
    camera.camera.fx_px *= factor;
    camera.camera.fy_px *= factor;
    camera.camera.cx_px += random.normal(0.0, kPrincipal_px);
    camera.camera.cy_px += random.normal(0.0, kPrincipal_px);
  }
  GeometricRun run = draw_geometric_run(config);
  for (std::size_t c = 0; c < stated.size(); ++c) run.observations.cameras[c].camera = stated[c].camera;
  return run;
}

TEST(MlLenses, AreEstimatedAndTheUncertaintyIsTrueOverTrials) {
  MlOptions options = told();
  options.priors.focal_relative = kFocal;
  options.priors.principal_point_px = kPrincipal_px;
  double mean = 0.0;
  MeanSquare focal, principal;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const GeometricRun run = run_with_wrong_lenses(seed);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    mean += nees(estimate, poses_of(run.truth)) / kTrials.count();
    for (std::size_t c = 0; c < run.truth.cameras.size(); ++c) {
      const Camera &is = run.truth.cameras[c].camera, &stated = run.observations.cameras[c].camera;
      const std::string& name = run.truth.cameras[c].name;
      focal.add(estimate.result, name, "focal_length_percent", 100.0 * (is.fx_px / stated.fx_px - 1.0));
      principal.add(estimate.result, name, "principal_point_x_px", is.cx_px - stated.cx_px);
      principal.add(estimate.result, name, "principal_point_y_px", is.cy_px - stated.cy_px);
      EXPECT_LT(value_of(estimate.result, name, "focal_length_percent", &EstimatedQuantity::sigma), 100.0 * kFocal);
    }
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  focal.expect_one();
  principal.expect_one();
}

// In the farthest corner, whatever the lens, and where a fisheye's corners see nothing.
TEST(MlLenses, APixelOfDistortionIsAPixelInTheCorner) {
  for (const auto& [kind, coefficients, focal_px] :
       {std::tuple(Lens::kPinhole, std::array<double, 5>{}, 640.0),
        std::tuple(Lens::kBrownConrady, std::array<double, 5>{-0.05, 0.02, 0.001, -0.002, 0.003}, 640.0),
        std::tuple(Lens::kKannalaBrandt, std::array<double, 5>{0.01, -0.004, 0.002, -0.001, 0.0}, 640.0),
        std::tuple(Lens::kKannalaBrandt, std::array<double, 5>{}, 400.0)}) {
    Camera camera = Camera::symmetric(1280, 720, focal_px);
    camera.lens = kind;
    camera.distortion = coefficients;
    ml::LensChange change = ml::LensChange::Zero();
    change[4] = 1.0;
    const Camera changed = ml::Lenses(camera).changed(change);
    // As far out as the lens still shows, the cube of the distance says how much of the pixel is left.
    const Eigen::Vector2d corner(0.0, 0.0), centre(camera.cx_px, camera.cy_px);
    Eigen::Vector3d ray;
    const bool sees = camera.unproject(corner, &ray);
    const double share = sees ? 1.0 : 0.7;
    Eigen::Vector2d after;
    ASSERT_TRUE(camera.unproject(centre + share * (corner - centre), &ray));
    ASSERT_TRUE(changed.project(ray, &after));
    EXPECT_NEAR((after - centre).norm() - share * (corner - centre).norm(), share * share * share, 0.15) << focal_px;
  }
}

TEST(MlLenses, WithoutPriorsTheErrorShows) { EXPECT_TRUE(error_shows(run_with_wrong_lenses(0))); }

struct ClockRun {
  GeometricRun run;
  std::vector<double> offset_s;  // of each camera's stamps
  double turn_lag_s = 0.0;
};

// All cameras take their images at one time while the robot moves, and stamp them by clocks of their own. The
// odometry is read at the stamp of the middle camera; its wheels turn before the body does.
ClockRun run_with_wrong_clocks(int seed, bool moving = true, bool lens_of_every_kind = false) {
  GeometricConfig config;
  if (lens_of_every_kind) {
    config.rig.cameras[1].camera.lens = Lens::kBrownConrady;
    config.rig.cameras[1].camera.distortion = {-0.05, 0.02, 0.001, -0.002, 0.003};
    config.rig.cameras[2].camera.lens = Lens::kKannalaBrandt;
    config.rig.cameras[2].camera.distortion = {0.01, -0.004, 0.002, -0.001, 0.0};
  }
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  RandomStream random(config.seed, "clock errors");
  std::vector<double> offset_s;
  for (std::size_t c = 0; c < config.rig.cameras.size(); ++c) offset_s.push_back(random.normal(0.0, kClock_s));
  const double turn_lag_s = random.normal(0.0, kTurnLag_s);
  const GeometricScene at_images = draw_scene(config);
  GeometricScene at_stamps = at_images;
  std::vector<Eigen::Vector3d> velocities;
  for (Rigid3& T : at_stamps.T_world_robot) {
    velocities.emplace_back(random.uniform(-0.8, 0.8), random.uniform(-0.1, 0.1), random.uniform(-0.8, 0.8));
    if (!moving) velocities.back().setZero();
    const Eigen::Vector3d step = offset_s[1] * velocities.back();
    T = T * planar_pose(step.x(), step.y(), step.z() + turn_lag_s * velocities.back().z());
  }
  ClockRun made{draw_geometric_run(config, at_images), offset_s, turn_lag_s};
  Observations& observations = made.run.observations;
  observations.stops = draw_geometric_run(config, at_stamps).observations.stops;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    observations.stops[i].stamp_s += offset_s[1];
    observations.stops[i].velocity = velocities[i];
  }
  for (BoardView& view : observations.board_views) view.stamp_s += offset_s[static_cast<std::size_t>(view.camera)];
  return made;
}

TEST(MlClocks, AnImageOfARobotThatSpeedsUpLiesOnItsWay) {
  Stop stop;
  stop.velocity << 0.6, 0.0, 0.5;
  stop.acceleration << 1.0, 0.0, -2.5;
  const ml::OdometryMotion motion(stop);
  ml::RobotPose at_stop;
  at_stop.x_m = 3.0;
  at_stop.yaw_rad = 0.0;
  constexpr double kLate_s = 0.03, kLag_s = 0.01, kStep_s = 1e-5, kScale = 1.02, kYawFactor = 0.98;
  const auto pose = [&](double late_s, double lag_s) {
    const ml::RobotPose at = ml::pose_at_image(at_stop, motion, late_s, lag_s, kScale, kYawFactor).pose;
    return Eigen::Vector3d(at.x_m, at.y_m, at.yaw_rad);
  };
  const double yaw_late_s = kLate_s + kLag_s;
  const Eigen::Vector3d expected(3.0 - (0.6 * kLate_s - 0.5 * kLate_s * kLate_s) / kScale, 0.0,
                                 -(0.5 * yaw_late_s + 0.5 * 2.5 * yaw_late_s * yaw_late_s) / kYawFactor);
  EXPECT_LT((pose(kLate_s, kLag_s) - expected).norm(), 1e-12);
  const auto by_times = ml::pose_at_image(at_stop, motion, kLate_s, kLag_s, kScale, kYawFactor).by_times;
  const Eigen::Vector3d by_clock = (pose(kLate_s + kStep_s, kLag_s) - pose(kLate_s - kStep_s, kLag_s)) / (2 * kStep_s);
  const Eigen::Vector3d by_lag = (pose(kLate_s, kLag_s + kStep_s) - pose(kLate_s, kLag_s - kStep_s)) / (2 * kStep_s);
  EXPECT_LT((by_times.col(0) - by_clock).norm(), 1e-8);
  EXPECT_LT((by_times.col(1) - by_lag).norm(), 1e-8);
}

TEST(MlClocks, AreEstimatedWhileMovingAndTheUncertaintyIsTrueOverTrials) {
  MlOptions options = told();
  options.priors.clock_offset_s = kClock_s;
  double mean = 0.0;
  MeanSquare offset;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const ClockRun made = run_with_wrong_clocks(seed);
    const std::vector<Rigid3> truth = poses_of(made.run.truth);
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    mean += nees(estimate, truth) / kTrials.count();
    for (std::size_t c = 0; c < truth.size(); ++c) {
      const std::string& name = made.run.truth.cameras[c].name;
      offset.add(estimate.result, name, "clock_offset_ms", 1e3 * made.offset_s[c]);
      EXPECT_LT(value_of(estimate.result, name, "clock_offset_ms", &EstimatedQuantity::sigma), 0.5e3 * kClock_s);
    }
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  offset.expect_one();
}

constexpr double kScatter_s = 1e-3;

// As by drivers that stamp images when they arrive.
ClockRun run_with_scattered_stamps(int seed) {
  constexpr double kReadoutSigma_s = 0.01;
  ClockRun made = run_with_wrong_clocks(seed);
  RandomStream random(static_cast<std::uint64_t>(seed), "scattered stamps");
  for (BoardView& view : made.run.observations.board_views) view.stamp_s += random.normal(0.0, kScatter_s);
  for (RigCamera& camera : made.run.observations.cameras) camera.readout_sigma_s = kReadoutSigma_s;
  return made;
}

// Stamps displace images along the motion alone, and images are taken to be displaced alike along all axes: what is
// stated is a little too small.
TEST(MlClocks, ThatScatterAreAllowedForAndTold) {
  constexpr double kMostTooSmall = 1.6;
  MlOptions options = told();
  options.priors.clock_offset_s = kClock_s;
  options.estimate_corner_level = true;
  double allowing = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const ClockRun made = run_with_scattered_stamps(seed);
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    const auto note = std::find_if(estimate.result.notes.begin(), estimate.result.notes.end(),
                                   [](const Finding& finding) { return finding.is("images.displaced"); });
    ASSERT_NE(note, estimate.result.notes.end()) << seed;
    const double told_s = 1e-3 * std::get<double>(note->find("stamps_ms")->value);
    EXPECT_GT(told_s, 0.2 * kScatter_s) << seed;
    EXPECT_LT(told_s, 1.2 * kScatter_s) << seed;
    allowing += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
  }
  EXPECT_LT(allowing, kMostTooSmall * kUnknowns + kTrials.chi_square_tolerance(kUnknowns));
}

TEST(MlClocks, WithoutPriorsTheErrorShows) { EXPECT_TRUE(error_shows(run_with_wrong_clocks(0).run)); }

// The body turns later than its wheels: taken for rigid, that is an error of every clock beyond five of its sigmas, and
// of longer lags a contradiction.
TEST(MlClocks, OfABodyThatIsTakenForRigidAreWrong) {
  MlOptions options = told();
  options.priors.clock_offset_s = kClock_s;
  options.priors.turn_lag_s = 0.0;
  int answered = 0;
  for (int seed = 0; seed < 20 && answered == 0; ++seed) {
    const ClockRun made = run_with_wrong_clocks(seed);
    if (std::abs(made.turn_lag_s) < 0.35 * kTurnLag_s) continue;
    const MlEstimate rigid = estimate_maximum_likelihood(made.run.observations, options);
    if (rigid.result.status == ResultStatus::kRefused) {
      EXPECT_FALSE(rigid.contradictions.empty()) << made.turn_lag_s;
      continue;
    }
    ++answered;
    for (std::size_t c = 0; c < made.offset_s.size(); ++c) {
      MeanSquare offset;
      offset.add(rigid.result, made.run.truth.cameras[c].name, "clock_offset_ms", 1e3 * made.offset_s[c]);
      EXPECT_GT(offset.sum, 25.0) << made.turn_lag_s;
    }
  }
  EXPECT_EQ(answered, 1);
}

TEST(MlClocks, OfARobotThatStandsKeepTheirPrior) {
  const ClockRun made = run_with_wrong_clocks(3, false);
  MlOptions options = told();
  const MlEstimate believing = estimate_maximum_likelihood(made.run.observations, options);
  options.priors.clock_offset_s = kClock_s;
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  for (std::size_t c = 0; c < 3; ++c) {
    const Rigid3 &a = estimate.state.T_robot_camera[c], &b = believing.state.T_robot_camera[c];
    EXPECT_LT(transform_error(a, b).norm(), 1e-9);
    const std::string& name = made.run.truth.cameras[c].name;
    EXPECT_NEAR(value_of(estimate.result, name, "clock_offset_ms", &EstimatedQuantity::value), 0.0, 1e-9);
    EXPECT_NEAR(value_of(estimate.result, name, "clock_offset_ms", &EstimatedQuantity::sigma), 1e3 * kClock_s, 1e-9);
  }
  const auto note = std::find_if(estimate.result.notes.begin(), estimate.result.notes.end(),
                                 [](const Finding& finding) { return finding.is("clock.offsets_unknown"); });
  ASSERT_NE(note, estimate.result.notes.end());
  EXPECT_NE(worded(*note).find("not observable: by the odometry the robot stood"), std::string::npos);
}

// Nothing is known of lenses, board and depth but what is usual.
void as_strangers_are(Observations* observations) {
  observations->board.doubt();
  for (RigCamera& camera : observations->cameras) {
    camera.intrinsics_sigma = IntrinsicsSigma();
    camera.depth->noise.doubt_place_and_common_scale();
  }
}

// A run with all that nuisances act on: planes of both kinds, images and clouds, several makes, boards and readouts.
ClockRun run_of_everything(bool lenses, int boards) {
  ClockRun made = run_with_wrong_clocks(5, true, lenses);
  Observations& observations = made.run.observations;
  if (lenses) as_strangers_are(&observations);
  observations.more_boards.assign(static_cast<std::size_t>(boards) - 1, observations.board);
  for (BoardView& view : observations.board_views) view.board = view.camera % boards;
  PlaneObservation plane = observations.ground_planes.front();
  plane.inverse_depth_plane << 0.05, 0.1, 0.5;
  observations.board_planes = {plane, plane};
  observations.board_planes.back().camera = boards - 1;  // on the last board
  // Planes of depth images move with the lens.
  observations.board_planes.back().file = "left/depth/000000.png";
  for (std::size_t i = 0; i < observations.ground_planes.size(); i += 2)
    observations.ground_planes[i].file = "depth/000000.png";
  for (int c = 0; c < 3; ++c) observations.cameras[static_cast<std::size_t>(c)].readout_s = 0.002 * c;
  observations.cameras[2].depth->noise.common_scale_sigma *= 0.5;  // of what depth scales share it has half
  observations.cameras[0].sensor = "of another make";
  return made;
}

ml::Priors priors_of_everything(const Observations& observations, double clock_sigma_s, bool lenses) {
  PriorSigmas sigmas;
  sigmas.odometry_veer_rad_per_m = 0.01;
  sigmas.clock_offset_s = clock_sigma_s;
  sigmas.turn_lag_s = kTurnLag_s;
  sigmas.readout_s = clock_sigma_s > 0.0 || !lenses ? 0.015 : 0.0;
  ml::Priors priors = ml::Priors::of({observations, sigmas, false});
  for (int c = 0; c < 3; ++c) {
    priors.covariance(ml::Nuisance::kDepthScale, c)(0, 0) = 1e-4;
    priors.covariance(ml::Nuisance::kGroundOffset, c) = 1e-6 * Eigen::Matrix3d::Identity();
    if (lenses) priors.covariance(ml::Nuisance::kDepthShape, c) = 1e-4 * Eigen::MatrixXd::Identity(6, 6);
  }
  return priors;
}

// Off zero in everything.
void move_nuisances(double clock_sigma_s, bool lenses, int boards, ml::NuisanceValues* nuisances) {
  nuisances->of(ml::Nuisance::kOdometryFactors) << 0.02, -0.03;
  nuisances->of(ml::Nuisance::kOdometryVeer)[0] = 0.004;
  if (clock_sigma_s > 0.0) {
    for (int c = 0; c < 3; ++c) nuisances->of(ml::Nuisance::kClockOffset, c)[0] = 0.012 - 0.016 * c;
    nuisances->of(ml::Nuisance::kTurnLag)[0] = 0.015;
  }
  if (lenses) {
    for (int c = 0; c < 3; ++c) nuisances->of(ml::Nuisance::kLens, c) << 0.002, 0.7 - c, -0.4, 0.0004, 0.2;
    for (int b = 0; b < boards; ++b)
      nuisances->of(ml::Nuisance::kBoardShape, b) << 0.004 - 0.003 * b, -0.001, 0.0003, -0.0002;
    nuisances->of(ml::Nuisance::kCommonDepthScale, 0)[0] = 0.005;
    nuisances->of(ml::Nuisance::kCommonDepthScale, 1)[0] = -0.004;
    for (int c = 0; c < 3; ++c)
      nuisances->of(ml::Nuisance::kDepthShape, c) << 0.003, -0.002, 0.004, 0.001, -0.003, 0.002;
  }
  for (int c = 0; c < 3; ++c) nuisances->of(ml::Nuisance::kReadout, c)[0] = 0.005 + 0.003 * c;
}

// Against central differences, unknown by unknown.
void expect_gradient(const ml::Problem& problem, const ml::State& state) {
  const ml::Layout& layout = problem.layout();
  const ml::ArrowSystem system = problem.linearise(state, ml::Weighting::kRobust, nullptr, nullptr);
  const auto cost_at = [&](const Eigen::VectorXd& poses, const Eigen::VectorXd& globals) {
    double cost = 0.0;
    problem.linearise(ml::moved(state, layout, poses, globals), ml::Weighting::kRobust, &cost, nullptr);
    return cost;
  };
  const auto expect_slope = [&](const Eigen::VectorXd& poses, const Eigen::VectorXd& globals, double gradient,
                                int unknown) {
    const double slope = (cost_at(poses, globals) - cost_at(-poses, -globals)) / 2.0;
    const double step = poses.norm() + globals.norm();
    EXPECT_NEAR(2.0 * gradient, slope / step, 1e-4 * (std::abs(2.0 * gradient) + 1.0)) << unknown;
  };
  const Eigen::VectorXd no_poses = Eigen::VectorXd::Zero(6 * layout.poses);
  const Eigen::VectorXd no_globals = Eigen::VectorXd::Zero(layout.globals());
  constexpr double kStep = 1e-6;
  for (int i = 0; i < layout.globals(); ++i) {
    Eigen::VectorXd step = no_globals;
    step[i] = kStep;
    expect_slope(no_poses, step, system.global_gradient[i], i);
  }
  for (int i = 6; i < 18; ++i) {
    Eigen::VectorXd step = no_poses;
    step[i] = kStep;
    expect_slope(step, no_globals, system.pose_gradient[i], -i);
  }
}

// The gradient of the cost by every global unknown, with everything estimated at once.
void expect_right_derivatives(double clock_sigma_s, bool lenses, int boards = 1) {
  const ClockRun made = run_of_everything(lenses, boards);
  const Observations& observations = made.run.observations;
  const ml::Priors priors = priors_of_everything(observations, clock_sigma_s, lenses);
  ml::NoiseLevels levels;
  levels.corner_scale = levels.ground_scale = levels.board_plane_scale = {1.0, 1.0, 1.0};
  const ml::Problem problem(observations, priors, levels);
  CalibrationState values = state_of(made.run.truth);
  values.T_world_more_boards.assign(static_cast<std::size_t>(boards) - 1, values.T_world_board);
  ml::State state = ml::state_from(values);
  move_nuisances(clock_sigma_s, lenses, boards, &state.nuisances);
  for (std::size_t n = 0; clock_sigma_s > 0.0 && lenses && n < ml::kNuisances; ++n)
    EXPECT_TRUE(problem.layout().has(static_cast<ml::Nuisance>(n))) << n;
  expect_gradient(problem, state);
}

TEST(MlClocks, AndLensesHaveRightDerivatives) {
  expect_right_derivatives(kClock_s, true);
  expect_right_derivatives(0.0, true);
  expect_right_derivatives(0.0, false);
  expect_right_derivatives(kClock_s, true, 2);
}

// Cameras without a common trigger, within one stop: each one's images show where the robot is at their true stamps.
// @param speeding_up largest accelerations, as (along, across, turn) [m/s^2, m/s^2, rad/s^2]
GeometricRun run_without_trigger(int seed, const Eigen::Vector3d& speeding_up = Eigen::Vector3d::Zero()) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  RandomStream random(config.seed, "speeds"), more(config.seed, "speeding up");
  const GeometricScene at_stops = draw_scene(config);
  std::vector<Eigen::Vector3d> velocities, accelerations;
  for (std::size_t i = 0; i < at_stops.T_world_robot.size(); ++i) {
    velocities.emplace_back(random.uniform(-0.8, 0.8), random.uniform(-0.1, 0.1), random.uniform(-0.8, 0.8));
    const Eigen::Vector3d share(more.uniform(-1.0, 1.0), more.uniform(-1.0, 1.0), more.uniform(-1.0, 1.0));
    accelerations.emplace_back(speeding_up.cwiseProduct(share));
  }
  GeometricRun run = draw_geometric_run(config, at_stops);
  std::vector<BoardView> views;
  for (std::size_t camera = 0; camera < config.rig.cameras.size(); ++camera) {
    const double delay_s = 0.008 * static_cast<double>(camera);
    GeometricScene at_images = at_stops;
    for (std::size_t i = 0; i < velocities.size(); ++i) {
      const Eigen::Vector3d step = delay_s * velocities[i] + 0.5 * delay_s * delay_s * accelerations[i];
      at_images.T_world_robot[i] = at_images.T_world_robot[i] * planar_pose(step.x(), step.y(), step.z());
    }
    for (BoardView& view : draw_geometric_run(config, at_images).observations.board_views) {
      if (view.camera != static_cast<int>(camera)) continue;
      view.stamp_s += delay_s;
      views.push_back(view);
    }
  }
  std::sort(views.begin(), views.end(), [](const BoardView& a, const BoardView& b) {
    return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
  });
  run.observations.board_views = views;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    run.observations.stops[i].velocity = velocities[i];
    run.observations.stops[i].acceleration = accelerations[i];
  }
  return run;
}

TEST(MlClocks, ImagesOfARobotThatSpeedsUpAreBelievedOverTrials) {
  constexpr int kIgnoring = 2;  // refusals take long
  double following = 0.0, ignoring = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    GeometricRun run = run_without_trigger(seed, {1.0, 0.0, 3.0});
    const auto off = [&run] {
      const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
      return estimate.result.joint_covariance ? nees(estimate, poses_of(run.truth)) : kNoChance;  // refused
    };
    following += off() / kTrials.count();
    if (seed >= kIgnoring) continue;
    for (Stop& stop : run.observations.stops) stop.acceleration.setZero();
    ignoring += off() / kIgnoring;
  }
  EXPECT_NEAR(following, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_GT(ignoring, 2.0 * kUnknowns) << "against " << following;
}

TEST(MlClocks, TrueStampsOfCamerasWithoutATriggerAreBelievedOverTrials) {
  double believing = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const GeometricRun run = run_without_trigger(seed);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    EXPECT_TRUE(estimate.result.also_estimated.empty());
    believing += nees(estimate, poses_of(run.truth)) / kTrials.count();
  }
  EXPECT_NEAR(believing, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

TEST(MlClocks, WithoutStampsOfTheirOwnTheErrorOfCamerasWithoutATriggerShows) {
  GeometricRun run = run_without_trigger(0);
  for (BoardView& view : run.observations.board_views)
    view.stamp_s = run.observations.stops[static_cast<std::size_t>(view.stop)].stamp_s;
  EXPECT_TRUE(error_shows(run));
}

// Wheels that are integrated along the way tell how a point moves that turns leave in place; it lies off the origin.
TEST(MlRotationCentre, OffTheOriginIsInTheUncertaintyOverTrials) {
  MlOptions options = told();
  options.along_way = true;
  options.priors.rotation_centre_m = 0.06;  // far beyond the noise
  MlOptions believing = options;
  believing.priors.rotation_centre_m = 0.0;
  double with = 0.0, without = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    GeometricConfig config;
    config.seed = static_cast<std::uint64_t>(seed);
    config.stops = 15;
    config.along_way = true;
    const GeometricRun run = draw_geometric_run(config);
    RandomStream random(config.seed, "rotation centre");
    std::vector<Rigid3> truth = poses_of(run.truth);
    const auto drawn_m = [&] { return random.normal(0.0, options.priors.rotation_centre_m); };
    const Eigen::Vector2d centre_m = draw_vector<2>(drawn_m);
    for (Rigid3& T : truth) T.translation.head<2>() += centre_m;
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    with += nees(estimate, truth) / kTrials.count();
    without += nees(estimate_maximum_likelihood(run.observations, believing), truth) / kTrials.count();
  }
  EXPECT_NEAR(with, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_GT(without, 1.5 * kUnknowns);
}

// The rig's word counts, unless a setting of the method says otherwise.
TEST(MlRotationCentre, AndRidingHeightMayStandInTheRig) {
  OdometryNoise stated;
  stated.rotation_centre_sigma_m = 0.0;
  stated.riding_height_sigma_m = 0.001;
  const PriorSigmas of_rig = with_those_of_rig(usual_priors(), stated);
  EXPECT_EQ(of_rig.rotation_centre_m, 0.0);
  EXPECT_EQ(of_rig.riding_height_m, 0.001);
  PriorSigmas asked = usual_priors();
  asked.rotation_centre_m = 0.02;
  EXPECT_EQ(with_those_of_rig(asked, stated).rotation_centre_m, 0.02);
  EXPECT_EQ(with_those_of_rig(usual_priors(), OdometryNoise()).rotation_centre_m, usual_priors().rotation_centre_m);
}

// So do wheels and clocks.
TEST(MlPriors, OfWheelsMayStandInTheRig) {
  OdometryNoise stated;
  stated.scale_sigma = 0.02;
  stated.yaw_factor_sigma = 0.0;
  stated.veer_sigma_rad_per_m = 0.001;
  stated.turn_lag_sigma_s = 0.005;
  const PriorSigmas of_rig = with_those_of_rig(usual_priors(), stated);
  EXPECT_EQ(of_rig.odometry_scale, 0.02);
  EXPECT_EQ(of_rig.odometry_yaw_factor, 0.0);
  EXPECT_EQ(of_rig.odometry_veer_rad_per_m, 0.001);
  EXPECT_EQ(of_rig.turn_lag_s, 0.005);
  const PriorSigmas without = with_those_of_rig(usual_priors(), OdometryNoise());
  EXPECT_EQ(without.odometry_scale, usual_priors().odometry_scale);
  PriorSigmas asked = usual_priors();
  asked.asked = {&PriorSigmas::turn_lag_s};
  EXPECT_EQ(with_those_of_rig(asked, stated).turn_lag_s, usual_priors().turn_lag_s) << "asked for, though it is usual";
}

// Wheels whose factors are believed are no free unknowns, and make increments no likelier than they are.
TEST(MlPriors, OfWheelsThatAreBelievedLeaveNoFactors) {
  for (const OdometryModel model : {OdometryModel::kPerIncrement, OdometryModel::kPerPose}) {
    GeometricConfig config;
    config.stops = 40;
    config.odometry_model = model;
    config.declare_odometry_model = false;
    Observations observations = draw_geometric_run(config).observations;
    observations.odometry_noise.scale_sigma = observations.odometry_noise.yaw_factor_sigma = 0.0;
    const MlEstimate estimate = estimate_maximum_likelihood(observations, told());
    EXPECT_EQ(estimate.result.status, ResultStatus::kSolved);
    EXPECT_EQ(estimate.noise.law.model, model);
    EXPECT_EQ(estimate.state.odometry_scale, 1.0);
    EXPECT_EQ(estimate.state.odometry_yaw_factor, 1.0);
    EXPECT_EQ(estimate.noise.priors.odometry_scale, 0.0);
  }
}

TEST(MlClocks, MayStandInTheRigCameraByCamera) {
  ClockRun made = run_with_wrong_clocks(0);
  MlOptions asked = told();
  asked.priors.clock_offset_s = kClock_s;
  const MlEstimate by_setting = estimate_maximum_likelihood(made.run.observations, asked);
  for (RigCamera& camera : made.run.observations.cameras) camera.clock_offset_sigma_s = kClock_s;
  const MlEstimate by_rig = estimate_maximum_likelihood(made.run.observations, told());
  ASSERT_EQ(by_rig.result.status, ResultStatus::kSolved);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_LT(transform_error(by_rig.state.T_robot_camera[c], by_setting.state.T_robot_camera[c]).norm(), 1e-12);
  made.run.observations.cameras[1].clock_offset_sigma_s = 0.0;
  const Result two = estimate_maximum_likelihood(made.run.observations, told()).result;
  for (const EstimatedQuantity& quantity : two.also_estimated)
    EXPECT_FALSE(quantity.name == "clock_offset_ms" && quantity.camera == made.run.observations.cameras[1].name);
}

// A point that nobody measured is no reason to refuse what is known relative to it, and the answer says both.
TEST(MlRotationCentre, ThatNobodyMeasuredIsToldAndNoRefusal) {
  GeometricConfig config;
  config.stops = 15;
  config.along_way = true;
  GeometricRun run = draw_geometric_run(config);
  MlOptions options = told();
  options.along_way = true;
  const Result stated = estimate_maximum_likelihood(run.observations, options).result;
  run.observations.odometry_noise.rotation_centre_sigma_m.reset();
  const Result open = estimate_maximum_likelihood(run.observations, options).result;
  EXPECT_EQ(open.status, ResultStatus::kSolved);
  const auto note_of = [](const Result& result) -> std::string {
    const auto found = std::find_if(result.notes.begin(), result.notes.end(),
                                    [](const Finding& note) { return note.is("robot.rotation_centre"); });
    return found == result.notes.end() ? "" : worded(*found);
  };
  EXPECT_THAT(note_of(open),
              testing::AllOf(testing::HasSubstr("+-50.0 mm"), testing::HasSubstr("state `odometry.noise")));
  EXPECT_THAT(note_of(stated), testing::AllOf(testing::HasSubstr("+-5.0 mm"),
                                              testing::Not(testing::HasSubstr("state `odometry.noise"))));
  for (std::size_t c = 0; c < open.camera_to_robot.size(); ++c) {
    const Matrix6d more = *open.camera_to_robot[c].covariance - *stated.camera_to_robot[c].covariance;
    EXPECT_NEAR(more(0, 0), 0.05 * 0.05 - 0.005 * 0.005, 1e-9);
    EXPECT_NEAR(more(1, 1), 0.05 * 0.05 - 0.005 * 0.005, 1e-9);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      double whole = 0.0;
      for (const EstimatedTransform::Share& line : open.camera_to_robot[c].budget) whole += line.share[axis];
      EXPECT_NEAR(whole, 1.0, 1e-6);
    }
    const double of_the_rest = more.bottomRightCorner<4, 4>().norm();
    EXPECT_LT(of_the_rest, 1e-12);
  }
  for (std::size_t p = 0; p < open.camera_to_camera.size(); ++p)
    EXPECT_LT((*open.camera_to_camera[p].covariance - *stated.camera_to_camera[p].covariance).norm(), 1e-9);
}

// Without ways between the stops it is not counted, though wheels may have told the stops.
TEST(MlRotationCentre, IsOfOdometryAlongTheWayOnly) {
  GeometricConfig config;
  config.stops = 12;
  const GeometricRun run = draw_geometric_run(config);
  MlOptions options = told();
  const MlEstimate with = estimate_maximum_likelihood(run.observations, options);
  options.priors.rotation_centre_m = 0.0;
  const MlEstimate without = estimate_maximum_likelihood(run.observations, options);
  EXPECT_EQ(with.result.joint_covariance.value(), without.result.joint_covariance.value());
}

// Whichever law the noise of its way follows; what is tracked from outside is of no such point.
TEST(MlRotationCentre, IsOfAllOdometryThatWheelsTellBetweenTheStops) {
  GeometricConfig config;
  config.stops = 5;
  const Observations at_stops = draw_geometric_run(config).observations;
  config.along_way = true;
  const Observations with_ways = draw_geometric_run(config).observations;
  EXPECT_TRUE(ml::is_of_turning_point(OdometryModel::kPerIncrement, with_ways));
  EXPECT_FALSE(ml::is_of_turning_point(OdometryModel::kPerPose, with_ways));
  EXPECT_FALSE(ml::is_of_turning_point(OdometryModel::kPerIncrement, at_stops));
}

// Both move all cameras alike, so that their variance stands in the covariance of every pair.
TEST(MlCommonErrors, AddTheirVarianceAlongTheirAxis) {
  PriorSigmas priors;
  priors.rotation_centre_m = 0.02;
  priors.riding_height_m = 0.003;
  for (const bool along_way : {true, false}) {
    Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(12, 12);
    ml::add_common_errors(priors, along_way, &joint);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(12, 12);
    for (const Eigen::Index i : {0, 6})
      for (const Eigen::Index j : {0, 6}) {
        expected(i, j) = expected(i + 1, j + 1) = along_way ? 0.02 * 0.02 : 0.0;
        expected(i + 2, j + 2) = 0.003 * 0.003;
      }
    EXPECT_TRUE(joint.isApprox(expected, 1e-12)) << joint;
  }
}

// A robot that rides higher while it moves carries its cameras along: no view and no plane shows it.
TEST(MlRidingHeight, WhileMovingIsInTheUncertaintyOverTrials) {
  MlOptions options = told();
  options.priors.clock_offset_s = kClock_s;
  options.priors.riding_height_m = 0.002;
  double with = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const ClockRun made = run_with_wrong_clocks(seed);
    RandomStream random(static_cast<std::uint64_t>(seed), "riding height");
    std::vector<Rigid3> truth = poses_of(made.run.truth);
    const double height_m = random.normal(0.0, options.priors.riding_height_m);
    for (Rigid3& T : truth) T.translation.z() += height_m;
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    with += nees(estimate, truth) / kTrials.count();
  }
  EXPECT_NEAR(with, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

TEST(MlRidingHeight, OfARobotThatStandsIsNone) {
  MlOptions options = told();
  options.priors.riding_height_m = 0.002;
  const Observations observations = run_with_wrong_clocks(3, false).run.observations;
  const MlEstimate with = estimate_maximum_likelihood(observations, options);
  options.priors.riding_height_m = 0.0;
  const MlEstimate without = estimate_maximum_likelihood(observations, options);
  EXPECT_EQ(with.result.joint_covariance.value(), without.result.joint_covariance.value());
}

}  // namespace
}  // namespace rigproof
