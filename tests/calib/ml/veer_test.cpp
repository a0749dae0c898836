// Wheels of unequal diameters: the odometry's heading gains on the robot's with every metre forward.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

const Trials kTrials(8, 20);
constexpr int kUnknowns = 18;  // of three cameras

// With a tenth of the paper's noise, as of wheels that hardly slip.
GeometricConfig drive(int seed, double veer_rad_per_m) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  config.along_way = true;
  config.lambda = 0.1;
  config.odometry_veer_rad_per_m = veer_rad_per_m;
  return config;
}

// The drawn robot turns about its origin, and its wheels are what is to be shown.
MlOptions along_way() {
  MlOptions options;
  options.along_way = true;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  options.priors.rotation_centre_m = 0.0;
  return options;
}

const Finding* find(const Result& result, const char* code) {
  for (const std::vector<Finding>* findings : {&result.reasons, &result.notes})
    for (const Finding& finding : *findings)
      if (finding.is(code)) return &finding;
  return nullptr;
}

// Drawn as wheels are, for a prior that leaves it to the data. Who believes that there is none is refused, or surer
// than is right.
TEST(MlVeer, IsEstimatedAndDoesNotBendTheAnswerOverTrials) {
  const MlOptions options = along_way();
  MlOptions believing = options;
  believing.priors.odometry_veer_rad_per_m = 0.0;
  double with = 0.0;
  int bent = 0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "veer");
    const GeometricRun run = draw_geometric_run(drive(seed, random.normal(0.0, 0.01)));
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    with += nees(estimate, poses_of(run.truth)) / kTrials.count();
    const MlEstimate believed = estimate_maximum_likelihood(run.observations, believing);
    bent += !believed.result.joint_covariance || nees(believed, poses_of(run.truth)) > 2.0 * kUnknowns;
  }
  EXPECT_NEAR(with, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_GT(2 * bent, kTrials.count());
}

TEST(MlVeer, IsToldWhereTheDataShowIt) {
  constexpr double kVeer = 0.02;
  const GeometricRun straight = draw_geometric_run(drive(3, 0.0)), veering = draw_geometric_run(drive(3, kVeer));
  EXPECT_EQ(find(estimate_maximum_likelihood(straight.observations, along_way()).result, "odometry.veers"), nullptr);
  const Result result = estimate_maximum_likelihood(veering.observations, along_way()).result;
  EXPECT_EQ(result.status, ResultStatus::kSolved);
  const Finding* told = find(result, "odometry.veers");
  ASSERT_NE(told, nullptr);
  const double sigma = std::get<double>(told->find("sigma")->value);
  EXPECT_NEAR(std::get<double>(told->find("deg_per_m")->value), rad_to_deg(kVeer), 4.0 * sigma);
}

// Nobody says how the wheels err, and each motion's noise is taken for one of its own: it, too, is bent by all of them.
TEST(MlVeer, IsFoundInWholeMotions) {
  constexpr double kVeer = 0.02;
  GeometricConfig config = drive(5, kVeer);
  config.declare_odometry_model = config.declare_odometry_sigmas = false;
  GeometricRun run = draw_geometric_run(config);
  run.observations.odometry_noise.model = OdometryModel::kPerIncrement;
  MlOptions options = along_way();
  options.along_way = false;
  const Result result = estimate_maximum_likelihood(run.observations, options).result;
  const Finding* told = find(result, "odometry.veers");
  ASSERT_NE(told, nullptr);
  const double sigma = std::get<double>(told->find("sigma")->value);
  EXPECT_NEAR(std::get<double>(told->find("deg_per_m")->value), rad_to_deg(kVeer), 4.0 * sigma);
}

// Two of its prior's standard deviations: refused as no wheels, a quarter of the robots whose errors are what is
// assumed of them had no answer.
TEST(MlVeer, WithinItsPriorIsAnswered) {
  const GeometricRun run = draw_geometric_run(drive(4, 0.06));
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, along_way());
  EXPECT_EQ(estimate.result.status, ResultStatus::kSolved);
  EXPECT_NE(find(estimate.result, "odometry.veers"), nullptr);
  EXPECT_LT(nees(estimate, poses_of(run.truth)), 42.3) << "99.9 % of 18 unknowns";
}

// Ten degrees a metre are no wheels of a robot that anybody drives.
TEST(MlVeer, BeyondWhatWheelsDoIsAContradiction) {
  const Result result = estimate_maximum_likelihood(draw_geometric_run(drive(4, 0.2)).observations, along_way()).result;
  EXPECT_NE(result.status, ResultStatus::kSolved);
  EXPECT_NE(find(result, "odometry.veers_far"), nullptr) << worded(result.reasons).size();
}

}  // namespace
}  // namespace rigproof
