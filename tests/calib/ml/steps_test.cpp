// What moved during the drive is found, and named with its stop and size; healthy drives are left in peace.
#include "steps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bending.h"
#include "cases.h"
#include "moved_during.h"
#include "past_boards.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/conventions.h"
#include "trials.h"

namespace rigproof {
namespace {

const Trials kTrials(6, 40);

GeometricConfig drive(int seed, int stops) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = stops;
  return config;
}

Vector6d turned(double pitch_deg, double yaw_deg) {
  Vector6d change = Vector6d::Zero();
  change[4] = deg_to_rad(pitch_deg);
  change[5] = deg_to_rad(yaw_deg);
  return change;
}

double value(const Finding& finding, const char* name) {
  const FindingValue* found = finding.find(name);
  return found == nullptr ? std::nan("") : std::get<double>(found->value);
}

// Decrement g' H^-1 g of the normal equations.
double decrement(const ml::Problem& problem, const ml::State& state) {
  const auto eliminated =
      ml::EliminatedSystem::eliminate(problem.linearise(state, ml::Weighting::kInformation, nullptr, nullptr), 0.0);
  Eigen::VectorXd poses, globals;
  EXPECT_TRUE(eliminated && eliminated->step(&poses, &globals));
  const ml::ArrowSystem system = problem.linearise(state, ml::Weighting::kInformation, nullptr, nullptr);
  return -(poses.dot(system.pose_gradient) + globals.dot(system.global_gradient));
}

// The score of a step is what six more unknowns would gain, everything else following.
void expect_scores_are_gains(const GeometricRun& run, std::size_t bodies) {
  const MlOptions options;
  const ml::Preparation prepared = ml::prepare(run.observations, options);
  const ml::Fit fit = ml::choose_odometry(prepared).fit;
  const ml::Problem without = ml::problem_at(prepared, fit, fit.noise);
  std::vector<ml::StepScore> scores;
  ASSERT_TRUE(without.sums_with_leverage(fit.state, {3, 7, 9}, &scores));
  ASSERT_EQ(scores.size(), 3U * bodies);
  const ml::LossMoments& moments = ml::cauchy_moments(2);
  const double lengthening = std::pow(moments.weight / moments.weighted_square, 2);
  for (const ml::StepScore& score : scores) {
    if (score.step.bodies.size() > 1) continue;  // second poses move each camera by itself
    ml::Problem with = ml::problem_at(prepared, fit, fit.noise);
    with.add(score.step);
    ml::State state = fit.state;
    const int body = score.step.bodies.front();
    state.second_poses = {state.first_pose(body)};
    const double gain = lengthening * (decrement(with, state) - decrement(without, fit.state));
    // Relative rounding of systems whose conditions are about 1e10.
    EXPECT_NEAR(score.square, gain, 1e-4 * std::max(1.0, gain)) << body << " " << score.step.split;
  }
}

TEST(Steps, ScoreIsTheGainOfSixMoreUnknowns) {
  // Three cameras, all of them, and the board; and of two boards each.
  expect_scores_are_gains(draw_moved_during(drive(3, 12), 7, {1}, turned(0.02, 0.01)), 5);
  expect_scores_are_gains(drawn_past_boards_in_turn(drive(3, 16)), 6);
}

TEST(Steps, AKnockedCameraIsNamedWithStopAndSize) {
  for (const int camera : cases<int>({0, 1, 2})) {
    const GeometricRun run = draw_moved_during(drive(10 + camera, 20), 12, {camera}, turned(0.0, 0.7));
    const Result result = estimate_maximum_likelihood(run.observations).result;
    EXPECT_EQ(result.status, ResultStatus::kRefused);
    ASSERT_FALSE(result.reasons.empty());
    const Finding& cause = result.reasons.front();
    EXPECT_EQ(cause.code, "camera.moved");
    EXPECT_EQ(cause.cameras, std::vector<std::string>{run.truth.cameras[static_cast<std::size_t>(camera)].name});
    EXPECT_EQ(cause.stops, std::vector<int>{12});
    EXPECT_NEAR(value(cause, "turn_deg"), 0.7, 0.05);
    EXPECT_LT(value(cause, "shift_mm"), 5.0);
    EXPECT_EQ(value(cause, "from"), 11.0);
  }
}

// Whatever the size: what bends the answer by little is a warning, beside which the answer stands.
TEST(Steps, FromASuspicionToAnAbsurdity) {
  for (const double deg : cases<double>({5.0, 0.05, 0.3, 30.0})) {
    Vector6d change = turned(deg, 0.0);
    if (deg > 10.0) std::swap(change[3], change[4]);  // a roll: pitched as far it would not see the board any more
    const GeometricRun run = draw_moved_during(drive(20, 30), 10, {2}, change);
    const Result result = estimate_maximum_likelihood(run.observations).result;
    const bool little = deg < 0.1;
    EXPECT_EQ(result.status == ResultStatus::kSolved, little) << deg;
    const std::vector<Finding>& findings = little ? result.notes : result.reasons;
    EXPECT_TRUE(has_code(findings, little ? "camera.moved_slightly" : "camera.moved"))
        << deg << " " << findings_json(findings);
  }
}

// A knock can pass for odometry far worse than wheels are, and such levels hide it: it is looked for all the same.
TEST(Steps, PoorOdometryHidesNone) {
  GeometricConfig config = drive(4, 24);
  config.rig.cameras.resize(1);
  config.rig.T_robot_camera.resize(1);
  config.rig.min_cameras_per_stop = 1;
  GeometricRun run = draw_moved_during(config, 12, {0}, turned(0.0, 4.0));
  run.observations.odometry_noise = OdometryNoise();
  const MlOptions options;  // of which the preparation keeps a reference
  const ml::Preparation prepared = ml::prepare(run.observations, options);
  ml::Fit fit = ml::choose_odometry(prepared).fit;
  fit.noise.odometry_xy_m = 0.06;
  fit.noise.odometry_yaw_rad = 0.06;
  std::vector<ml::StepScore> scores;
  ASSERT_TRUE(ml::problem_at(prepared, fit, fit.noise).sums_with_leverage(fit.state, ml::splits_of(24, 16), &scores));
  for (const ml::StepScore& score : scores) EXPECT_LT(score.square, 36.0);
  const std::optional<ml::FoundStep> step = ml::find_step(prepared, fit, scores);
  ASSERT_TRUE(step);
  EXPECT_EQ(step->findings.front().code, "camera.moved");
  EXPECT_NEAR(value(step->findings.front(), "turn_deg"), 4.0, 0.3);
}

TEST(Steps, ASingleCamera) {
  GeometricConfig config = drive(4, 30);
  config.rig.cameras.resize(1);
  config.rig.T_robot_camera.resize(1);
  config.rig.min_cameras_per_stop = 1;
  const GeometricRun run = draw_moved_during(config, 15, {0}, turned(1.0, 0.0));
  const Result result = estimate_maximum_likelihood(run.observations).result;
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "camera.moved");
}

// Of a turning point that nobody measured more is unknown, but cameras that move bend as much.
TEST(Steps, AnUnknownTurningPointHidesNoBending) {
  GeometricConfig config = drive(4, 24);
  config.along_way = true;
  Observations observations = draw_geometric_run(config).observations;
  const MlOptions options;
  const auto bent_by_3_cm = [&](std::optional<double> rotation_centre_sigma_m) {
    observations.odometry_noise.rotation_centre_sigma_m = rotation_centre_sigma_m;
    const ml::Preparation prepared = ml::prepare(observations, options);
    const ml::Fit fit = ml::choose_odometry(prepared).fit;
    const std::optional<ml::GlobalCovariance> covariance = ml::stated_covariance(prepared, fit);
    ml::State bent = fit.state;
    bent.T_robot_camera[0].translation.x() += 0.03;
    return ml::bent_by(bent, prepared, fit, covariance.value());
  };
  const double of_known = bent_by_3_cm(0.005);
  EXPECT_GT(of_known, 1.0);
  EXPECT_NEAR(bent_by_3_cm(std::nullopt), of_known, 1e-9);
}

TEST(Steps, AllCamerasAsOneBody) {
  GeometricConfig config = drive(5, 20);
  const GeometricRun run = draw_moved_during(config, 10, {0, 1, 2}, turned(1.0, 0.0));
  const Result result = estimate_maximum_likelihood(run.observations).result;
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().code, "camera.moved");
  EXPECT_EQ(result.reasons.front().cameras.size(), 3U);
}

TEST(Steps, ABoardThatLeans) {
  const GeometricRun run = draw_board_moved_during(drive(6, 20), 10, turned(2.0, 0.0));
  const Result result = estimate_maximum_likelihood(run.observations).result;
  std::vector<Finding> all = result.reasons;
  all.insert(all.end(), result.notes.begin(), result.notes.end());
  EXPECT_TRUE(has_code(all, "board.moved") || has_code(all, "board.moved_slightly")) << findings_json(all);
  EXPECT_FALSE(has_code(all, "camera.moved"));
}

// Other lenses explain a little of it, and leave the data in order, too: the step explains twenty times as much.
TEST(Steps, ABoardThatLeansIsNotToldAsOtherLenses) {
  for (const int seed : {608, 619, 621}) {
    const GeometricRun run = draw_board_moved_during(drive(seed, 20), 10, turned(2.0, 0.0));
    const Result result = estimate_maximum_likelihood(run.observations).result;
    ASSERT_FALSE(result.reasons.empty()) << seed;
    EXPECT_EQ(result.reasons.front().code, "board.moved") << seed << findings_json(result.reasons);
    EXPECT_EQ(result.reasons.front().stops, std::vector<int>{10}) << seed;
    EXPECT_FALSE(has_code(result.reasons, "lens.half_pixel_slip")) << seed;
  }
}

// In the plane of the floor a board that was moved is a slip of the wheels: it is ignored, and the answer stands.
TEST(Steps, ABoardThatIsPushedAsideBendsNothing) {
  Vector6d aside = Vector6d::Zero();
  aside[1] = 0.3;
  const GeometricRun run = draw_board_moved_during(drive(7, 20), 10, aside);
  const Result result = estimate_maximum_likelihood(run.observations).result;
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  EXPECT_TRUE(has_code(result.notes, "odometry.slip"));
}

TEST(Steps, HealthyDrivesAreLeftInPeaceOverTrials) {
  for (int i = 0; i < kTrials.count(); ++i) {
    GeometricConfig config = drive(100 + i, 10 + 10 * (i % 3));
    if (i % 2 == 1) config.rig = random_rig(config.seed, 1 + i % 4);
    config.declare_odometry_model = config.declare_odometry_sigmas = i % 3 == 0;
    const Result result = estimate_maximum_likelihood(draw_geometric_run(config).observations).result;
    for (const auto* findings : {&result.reasons, &result.notes})
      for (const Finding& finding : *findings) EXPECT_EQ(finding.code.find(".moved"), std::string::npos) << i;
  }
}

}  // namespace
}  // namespace rigproof
