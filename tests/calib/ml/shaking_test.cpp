// A camera on a loose mount: each of its images is displaced as a whole.
#include <gtest/gtest.h>

#include <algorithm>

#include "calibration_truth.h"
#include "examination.h"
#include "faults.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

const Trials kTrials(6, 20);
constexpr int kUnknowns = 18;  // of three cameras
constexpr int kLoose = 1;

GeometricRun drive(int seed, std::size_t cameras = 3) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  config.rig.cameras.resize(cameras);
  config.rig.T_robot_camera.resize(cameras);
  config.rig.min_cameras_per_stop = static_cast<int>(cameras);
  return draw_geometric_run(config);
}

// The corners' level has to be found: nobody states how a mount shakes.
MlOptions options_of_run() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_plane_level = false;
  return options;
}

// Nor how steadily the robot stands.
MlOptions options_of_stranger() {
  MlOptions options = options_of_run();
  options.suspension_height_sigma_m.reset();
  options.suspension_tilt_sigma_rad.reset();
  return options;
}

void shake(int camera, double sigma_px, int seed, Observations* observations) {
  RandomStream random(static_cast<std::uint64_t>(seed), "shaken");
  for (BoardView& view : observations->board_views) {
    const Eigen::Vector2d by_px(random.normal(0.0, sigma_px), random.normal(0.0, sigma_px));
    if (view.camera != camera) continue;
    for (CornerObservation& corner : view.corners) corner.pixel += by_px;
  }
}

void turn_by_half(int camera, Observations* observations) {
  const Camera& lens = observations->cameras[static_cast<std::size_t>(camera)].camera;
  for (BoardView& view : observations->board_views) {
    if (view.camera != camera) continue;
    for (CornerObservation& corner : view.corners)
      corner.pixel = Eigen::Vector2d(lens.width_px - 1, lens.height_px - 1) - corner.pixel;
  }
}

std::vector<const Finding*> told(const Result& result) {
  std::vector<const Finding*> all;
  for (const Finding& finding : result.notes)
    if (finding.is("images.shaken")) all.push_back(&finding);
  return all;
}

// Twenty corners that are displaced alike tell no more than one: who takes them for twenty is four times too sure.
TEST(MlShaking, AShakenCameraIsNamedAndAsUncertainAsItIsOverTrials) {
  double sum = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    GeometricRun run = drive(seed);
    shake(kLoose, 1.0, seed, &run.observations);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options_of_run());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed << worded(estimate.result.reasons).front();
    sum += nees(estimate, poses_of(run.truth)) / kTrials.count();
    const std::vector<const Finding*> findings = told(estimate.result);
    ASSERT_EQ(findings.size(), 1U) << seed;
    EXPECT_EQ(findings.front()->cameras, std::vector{run.observations.cameras[kLoose].name});
    EXPECT_NEAR(std::get<double>(findings.front()->find("by_px")->value), 1.4, 0.5) << seed;
  }
  EXPECT_LT(sum, kUnknowns + kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_GT(sum, 0.5 * kUnknowns);
}

TEST(MlShaking, OthersAnswersDoNotSuffer) {
  GeometricRun run = drive(3);
  const MlEstimate still = estimate_maximum_likelihood(run.observations, options_of_run());
  EXPECT_TRUE(told(still.result).empty());
  shake(kLoose, 1.0, 3, &run.observations);
  const MlEstimate shaken = estimate_maximum_likelihood(run.observations, options_of_run());
  ASSERT_TRUE(still.result.joint_covariance && shaken.result.joint_covariance);
  for (int camera = 0; camera < 3; ++camera) {
    const auto sigma = [&](const MlEstimate& estimate) {
      return std::sqrt((*estimate.result.joint_covariance)(6 * camera, 6 * camera));
    };
    if (camera == kLoose)
      EXPECT_GT(sigma(shaken), 1.1 * sigma(still));
    else
      EXPECT_LT(sigma(shaken), 1.6 * sigma(still)) << camera;
  }
}

// The robot's own unsteadiness is as likely beforehand: what else is known of its way decides.
TEST(MlShaking, OfTwoCamerasTheRightOneIsBlamed) {
  for (int seed = 0; seed < 3; ++seed) {
    GeometricRun run = drive(seed, 2);
    shake(kLoose, 1.0, seed, &run.observations);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options_of_stranger());
    const std::vector<const Finding*> findings = told(estimate.result);
    ASSERT_EQ(findings.size(), 1U) << seed;
    EXPECT_EQ(findings.front()->cameras, std::vector{run.observations.cameras[kLoose].name});
  }
}

// Shaking explains a little of all that displaces images: what is wrong beside it is still refused.
TEST(MlShaking, ExcusesNothingElse) {
  GeometricRun run = drive(2);
  shake(kLoose, 1.0, 2, &run.observations);
  Camera& stated = run.observations.cameras[0].camera;
  stated.fx_px *= 1.03;
  stated.fy_px *= 1.03;
  const Result result = estimate_maximum_likelihood(run.observations, options_of_run()).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_EQ(result.reasons.front().cameras, std::vector{run.observations.cameras[0].name});
}

std::optional<ml::Cause> without_excuses(const Observations& observations) {
  const MlOptions options = options_of_run();
  const ml::Preparation prepared = ml::prepare(observations, options);
  return ml::cause_without_excuses(prepared, ml::choose_odometry(prepared).fit);
}

// Upside down, the images of a camera are nearly those of one that lies as far below the board's middle as it lies
// above: without depth they passed for shaken by pixels, and the camera was stated 48 degrees away.
TEST(MlShaking, IsNoExcuseForImagesUpsideDown) {
  GeometricRun run = drive(5);
  EXPECT_FALSE(without_excuses(run.observations));
  const std::vector<std::string> loose = {run.observations.cameras[kLoose].name};
  const std::vector<ml::Fault> faults = ml::image_faults(run.observations);
  const auto mirrored = std::find_if(faults.begin(), faults.end(), [&loose](const ml::Fault& fault) {
    return fault.cause.is("images.mirrored") && fault.cause.cameras == loose;
  });
  ASSERT_NE(mirrored, faults.end());
  Observations turned = undone(*mirrored, run.observations);
  turn_by_half(kLoose, &turned);
  const std::optional<ml::Cause> cause = without_excuses(turned);
  ASSERT_TRUE(cause);
  EXPECT_EQ(cause->findings.front().code, "images.mirrored");
  EXPECT_EQ(cause->findings.front().cameras, loose);
  shake(kLoose, 3.0, 5, &run.observations);
  EXPECT_FALSE(without_excuses(run.observations));
}

// Images upside down were answered, wrong by 260 sigmas, when shaking was believed beside depth that did not fit them.
TEST(MlShaking, IsBelievedOnlyWhereNothingElseIsSuspected) {
  const ml::Examination clean;
  EXPECT_TRUE(clean.is_in_order());
  ml::Examination moved = clean, misplaced = clean, contradicted = clean, caused = clean;
  moved.notes.push_back(Finding("camera.moved_slightly"));
  misplaced.notes.push_back(Finding("depth.misplaced"));
  contradicted.contradictions.cameras.push_back(Finding("corners.off"));
  caused.cause = ml::Cause{{Finding("camera.moved")}};
  EXPECT_TRUE(moved.is_in_order());
  EXPECT_FALSE(misplaced.is_in_order());
  EXPECT_FALSE(contradicted.is_in_order());
  EXPECT_FALSE(caused.is_in_order());
}

// Alone, it shakes as its robot does: nothing holds its views.
TEST(MlShaking, ACameraAloneIsNotBlamed) {
  GeometricRun run = drive(4, 1);
  shake(0, 0.5, 4, &run.observations);
  EXPECT_TRUE(told(estimate_maximum_likelihood(run.observations, options_of_stranger()).result).empty());
}

}  // namespace
}  // namespace rigproof
