// Robots that nobody here built: lenses, board and depth differ from what is stated by errors drawn from the usual
// priors, all at once. The stated uncertainty holds, and without the priors it does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/calib/estimate/fit.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/calib/estimate/repeating_covariance.h"
#include "rigproof/calib/estimate/solver.h"
#include "rigproof/core/conventions.h"
#include "rigproof/geometric/geometric.h"
#include "stranger.h"
#include "trials.h"

namespace rigproof {
namespace {

const Trials kTrials(12, 60);
constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES

struct Driven : Stranger {
  GeometricRun run;
};

Driven stranger(int seed, double corner_sigma_px = 0.1, const Worse& worse = {}) {
  Driven made{draw_stranger(seed, corner_sigma_px, worse), {}};
  made.run = drive(made, static_cast<std::uint64_t>(seed), 20);
  return made;
}

MlOptions told() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  options.estimate_corner_level = options.estimate_plane_level = false;
  return options;
}

TEST(MlStrangers, AreSolvedWithinTheStatedUncertaintyOverTrials) {
  double mean = 0.0, z_square = 0.0;
  int suspicions = 0, values = 0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const Driven made = stranger(seed, 0.1, of_any_scale(seed));
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << seed;
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    mean += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
    for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
    for (const EstimatedQuantity& quantity : estimate.result.also_estimated) {
      if (quantity.name != "board_size_percent") continue;
      z_square += std::pow((quantity.value - 100.0 * made.board[0]) / quantity.sigma, 2);
      ++values;
    }
    ASSERT_EQ(estimate.result.lenses.size(), 3U);
    EXPECT_NEAR(estimate.result.lenses[1].intrinsics.fx_px, made.run.truth.cameras[1].camera.fx_px, 0.02 * 640.0);
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_EQ(values, kTrials.count());
  EXPECT_NEAR(z_square / values, 1.0, kTrials.chi_square_tolerance(1));
  EXPECT_EQ(suspicions, 0);
}

// How fine the field of a lens is nobody states: it may change within an eighth of the image or within a sixteenth.
TEST(MlStrangers, WhateverTheScaleOfTheirLensesFieldsTheStatementHoldsOverTrials) {
  double mean = 0.0;
  int suspicions = 0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    Worse worse;
    worse.cells = seed % 2 == 0 ? 8.0 : 16.0;
    const Driven made = stranger(seed, 0.1, worse);
    MlOptions options = told();
    options.estimate_corner_level = true;
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << seed;
    mean += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
    for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_EQ(suspicions, 0);
}

// Of three pixels; what no depth image is free of is a sixth of one.
TEST(MlStrangers, ShiftsOfDepthImagesThatAreBelievedToBeNoneShowOverTrials) {
  double believing = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    Driven made = stranger(seed);
    Observations& observations = made.run.observations;
    for (RigCamera& camera : observations.cameras) camera.depth->noise.shift_sigma_px = 0.0;
    for (auto* planes : {&observations.ground_planes, &observations.board_planes})
      for (PlaneObservation& plane : *planes)
        plane.inverse_depth_plane -= plane_by_depth_shape(plane.inverse_depth_plane).leftCols<2>() * 2.0 *
                                     made.shape[static_cast<std::size_t>(plane.camera)].head<2>();
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    believing += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
  }
  EXPECT_GT(believing, 1.4 * kUnknowns);
}

// Detectors see far finer than lenses and prints are made: what repeats in every image is not averaged away.
TEST(MlStrangers, WithSharpCornersWhatRepeatsInEveryImageIsCountedOverTrials) {
  constexpr int kBelievedOneIn = 6;  // robots is also solved as one without such errors
  double mean = 0.0, level = 0.0;
  std::vector<double> believed;
  int suspicions = 0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const Driven made = stranger(seed, 0.01);
    MlOptions options = told();
    options.estimate_corner_level = true;
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << seed;
    mean += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
    level += 0.01 * estimate.corner_scale[0] / kTrials.count();
    for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
    if (seed % kBelievedOneIn != 0) continue;
    Observations without = made.run.observations;
    without.board.print_sigma_m = 0.0;
    for (RigCamera& camera : without.cameras) camera.intrinsics_sigma.residual_px = 0.0;
    const MlEstimate exact = estimate_maximum_likelihood(without, options);
    believed.push_back(exact.result.joint_covariance ? nees(exact, poses_of(made.run.truth)) : 0.0);
  }
  EXPECT_NEAR(mean, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
  EXPECT_EQ(suspicions, 0);
  EXPECT_LT(level, 0.03);  // of .01 px, and waves that polynomials do not follow
  EXPECT_GT(std::accumulate(believed.begin(), believed.end(), 0.0),
            3.0 * kUnknowns * static_cast<double>(believed.size()));
}

// What polynomials and splines of a few grids make up for, of a field between them, is no contradiction. Where most of
// it lies beside the boards its size is hardly known, and a pose may be too uncertain for it.
TEST(MlStrangers, WithSharpCornersFieldsOfAnyScaleAreNotSuspectedOverTrials) {
  double sum = 0.0;
  int solved = 0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const Driven made = stranger(seed, seed % 2 == 0 ? 0.05 : 0.01, of_any_scale(seed));
    MlOptions options = told();
    options.estimate_corner_level = true;
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, options);
    for (const Finding& reason : estimate.result.reasons) EXPECT_EQ(reason.code, "pose.too_uncertain") << seed;
    for (const Finding& note : estimate.result.notes) EXPECT_NE(note.severity, Severity::kSuspect) << seed << note.code;
    if (estimate.result.status != ResultStatus::kSolved) continue;
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    sum += nees(estimate, poses_of(made.run.truth));
    ++solved;
  }
  EXPECT_GE(20 * solved, 19 * kTrials.count());
  EXPECT_NEAR(sum / solved, kUnknowns, kTrials.chi_square_tolerance(kUnknowns));
}

// What lenses have beside their models counts in the bound as much as in the answer: errors are as large as it allows.
TEST(MlStrangers, TheBoundIsReachedWithFieldsOfAnyScaleOverTrials) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(kUnknowns), allowed = squares, stated = squares;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    const Driven made = stranger(seed, 0.05, of_any_scale(seed));
    const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    const InformationBound bound =
        cramer_rao_bound(made.run.observations, state_of(made.run.truth), noise_of(made.run.truth));
    for (int c = 0; c < kUnknowns / 6; ++c) {
      const auto camera = static_cast<std::size_t>(c);
      squares.segment<6>(6 * c) +=
          transform_error(estimate.state.T_robot_camera[camera], made.run.truth.cameras[camera].T_robot_camera)
              .cwiseAbs2();
    }
    allowed += bound.joint.diagonal();
    stated += estimate.result.joint_covariance->diagonal();
  }
  for (int i = 0; i < kUnknowns; ++i) {
    EXPECT_LT(std::sqrt(stated[i] / allowed[i]), 1.15) << i;
    EXPECT_GT(std::sqrt(stated[i] / allowed[i]), 0.85) << i;
  }
  EXPECT_NEAR(squares.cwiseQuotient(allowed).mean(), 1.0, kTrials.chi_square_tolerance(kUnknowns) / kUnknowns);
}

// Fields bend the poses, and those meet the odometry: taken out, they leave it as it is stated.
TEST(MlStrangers, WithSharpCornersFieldsDoNotContradictTheOdometryOverTrials) {
  double squares = 0.0, redundancy = 0.0;
  for (int seed = 0; seed < kTrials.count(); ++seed) {
    Worse worse;
    worse.cells = 16.0;
    const Driven made = stranger(seed, 0.01, worse);
    MlOptions options = told();
    options.estimate_corner_level = true;
    const ml::Preparation prepared = ml::prepare(made.run.observations, options);
    const ml::Fit fit = ml::fit_model(prepared, {OdometryModel::kPerIncrement, false});
    const auto sums = ml::problem_at(prepared, fit, fit.noise).sums_with_leverage(fit.state);
    ASSERT_TRUE(sums) << seed;
    const ml::GroupSum& odometry = sum_of(*sums, ml::Group::kOdometryXy);
    squares += odometry.weighted_square / ml::cauchy_moments(3).weighted_square;
    redundancy += odometry.redundancy();
  }
  EXPECT_NEAR(squares / redundancy, 1.0, 3.0 * std::sqrt(2.0 / redundancy));
}

TEST(MlStrangers, BelievedToTheLastDigitTheirErrorsShow) {
  Driven made = stranger(0);
  MlOptions exact = told();
  exact.priors.believe_told = true;
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, exact);
  EXPECT_TRUE(!estimate.result.joint_covariance || nees(estimate, poses_of(made.run.truth)) > 1000.0);
}

// Each variance is what its sources leave of it, and nothing else.
TEST(MlStrangers, TheBudgetAddsUp) {
  const MlEstimate estimate = estimate_maximum_likelihood(stranger(1).run.observations, told());
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  for (const EstimatedTransform& transform : estimate.result.camera_to_robot) {
    std::array<double, 6> sum{};
    ASSERT_GE(transform.budget.size(), 5U);
    for (const EstimatedTransform::Share& line : transform.budget)
      for (std::size_t i = 0; i < 6; ++i) sum[i] += line.share[i];
    for (const double share : sum) EXPECT_NEAR(share, 1.0, 1e-6);
  }
}

// The camera and the quantity of each finding that something is further off than was stated.
std::vector<std::string> strained(const Worse& worse, int seed = 3) {
  MlOptions options = told();
  options.estimate_corner_level = true;
  const MlEstimate estimate = estimate_maximum_likelihood(stranger(seed, 0.05, worse).run.observations, options);
  std::vector<std::string> found;
  for (const Finding& note : estimate.result.notes)
    if (note.code == "prior.strained")
      found.push_back(std::get<std::string>(note.find("quantity")->value) +
                      (note.cameras.empty() ? "" : " of " + note.cameras.front()));
  return found;
}

// Polynomials that large may also be what they make of a finer field that is no larger than stated.
TEST(MlStrangers, AFieldSixTimesAsLargeIsNamedTwiceAsOftenAsNotOverTrials) {
  const Trials trials(6, 12);
  int named = 0;
  for (int seed = 0; seed < trials.count(); ++seed) {
    const std::string camera = stranger(seed).run.observations.cameras[1].name;
    const std::vector<std::string> found = strained({6.0, 1.0, 0.0}, seed);
    named += std::count(found.begin(), found.end(), "lens_residual_px of " + camera) > 0;
  }
  EXPECT_GE(3 * named, 2 * trials.count());
}

TEST(MlStrangers, WhatIsFurtherOffThanStatedIsNamed) {
  const std::string camera = stranger(3).run.observations.cameras[1].name;
  EXPECT_THAT(strained({}), testing::IsEmpty());
  EXPECT_THAT(strained({6.0, 1.0, 0.0}), testing::Contains("lens_residual_px of " + camera));
  EXPECT_THAT(strained({15.0, 1.0, 0.0}), testing::Contains("lens_residual_px of " + camera));
  EXPECT_THAT(strained({1.0, 6.0, 0.0}), testing::Contains("print_mm"));
  EXPECT_THAT(strained({1.0, 1.0, 0.04}), testing::Contains("depth_offset_mm of " + camera));
}

// A camera whose depth is exact has no part in the error that the others have in common.
TEST(MlStrangers, TheExactDepthOfOneCameraTellsTheCommonErrorOfTheOthers) {
  GeometricConfig config;
  config.stops = 20;
  config.board_planes = true;
  config.depth_scales = {1.0, 1.025, 1.026};
  GeometricRun run = draw_geometric_run(config);
  run.observations.board.doubt();
  for (std::size_t c = 0; c < 3; ++c) {
    DepthNoise& noise = run.observations.cameras[c].depth->noise;
    noise.scale_sigma = c == 0 ? 1e-5 : 0.003;
    noise.common_scale_sigma = c == 0 ? 0.0 : 0.01;
  }
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told());
  ASSERT_EQ(estimate.result.status, ResultStatus::kSolved);
  for (const Finding& note : estimate.result.notes) EXPECT_NE(note.severity, Severity::kSuspect) << note.code;
  for (const EstimatedQuantity& quantity : estimate.result.also_estimated)
    if (quantity.name == "common_depth_scale_percent") {
      EXPECT_NEAR(quantity.value, 2.5, 0.5);
    }
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(estimate.state.depth_scale[c], config.depth_scales[c], 1e-3) << c;
}

// Two cameras of one sensor measure 1.6 % too far, the third, of another or of an unknown one, 1.6 % too short. As
// three of one sensor they would be ten sigmas apart.
TEST(MlStrangers, CamerasOfDifferentSensorsShareNoDepthScale) {
  GeometricConfig config;
  config.stops = 20;
  config.board_planes = true;
  config.depth_scales = {1.016, 1.0165, 0.984};
  Observations observations = draw_geometric_run(config).observations;
  observations.board.doubt();
  for (RigCamera& camera : observations.cameras) {
    camera.depth->noise.scale_sigma = DepthNoise().scale_sigma;
    camera.depth->noise.common_scale_sigma = DepthNoise().common_scale_sigma;
  }
  const auto suspicions_and_makes = [&](const char* sensor) {
    observations.cameras[2].sensor = sensor;
    const MlEstimate estimate = estimate_maximum_likelihood(observations, told());
    EXPECT_EQ(estimate.result.status, ResultStatus::kSolved);
    std::vector<std::string> makes;
    for (const EstimatedQuantity& quantity : estimate.result.also_estimated)
      if (quantity.name == "common_depth_scale_percent") makes.push_back(quantity.camera);
    std::size_t suspicions = 0;
    for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
    return std::pair(suspicions, makes);
  };
  const std::string first = observations.cameras[0].name, third = observations.cameras[2].name;
  const std::vector<std::string> two = {first, third};
  EXPECT_EQ(suspicions_and_makes("another"), std::pair(std::size_t{0}, two));
  EXPECT_EQ(suspicions_and_makes(""), std::pair(std::size_t{0}, two));
  const auto [suspicions, makes] = suspicions_and_makes(observations.cameras[0].sensor.c_str());
  EXPECT_GT(suspicions, 0U);
  EXPECT_EQ(makes, std::vector<std::string>{first});
}

std::vector<std::string> with_misplaced_depth(const Observations& observations) {
  MlOptions options = told();
  options.estimate_plane_level = true;
  const MlEstimate estimate = estimate_maximum_likelihood(observations, options);
  EXPECT_EQ(estimate.result.status, ResultStatus::kSolved);
  std::vector<std::string> cameras;
  for (const Finding& note : estimate.result.notes)
    if (note.code == "depth.misplaced") cameras.push_back(note.cameras.front());
  return cameras;
}

// The finest depth shows what no depth image is free of: a fiftieth of a pixel where the lens is exact, more where it
// is estimated. Ten times as much is a fault.
TEST(MlStrangers, NoDepthIsSuspectedForWhatIsLeftOfItsLens) {
  GeometricConfig config;
  config.stops = 40;
  config.board_planes = true;
  config.ground_points = 3e5;
  config.board_points = 6e4;
  const GeometricRun run = draw_geometric_run(config);
  const auto suspected = [&](double off_px, double distortion_sigma_px) {
    Observations observations = run.observations;
    RigCamera& camera = observations.cameras[1];
    camera.intrinsics_sigma.distortion_px = distortion_sigma_px;
    const double off = off_px / camera.camera.fx_px;
    const Vector6d shape = (Vector6d() << off, -off, -off, off, off, off).finished();
    for (auto* planes : {&observations.ground_planes, &observations.board_planes})
      for (PlaneObservation& plane : *planes)
        if (plane.camera == 1) plane.inverse_depth_plane -= plane_by_depth_shape(plane.inverse_depth_plane) * shape;
    return with_misplaced_depth(observations).size();
  };
  EXPECT_EQ(suspected(0.02, 0.0), 0U);
  EXPECT_EQ(suspected(0.2, 0.0), 1U);
  EXPECT_EQ(suspected(0.03, 0.3), 0U);
}

// A depth image thirteen pixels aside turns no plane as a tilted camera would: the answer does not know of it, and says
// so.
TEST(MlStrangers, DepthThatIsShiftedAgainstItsImageIsNamed) {
  Eigen::Matrix<double, 6, 1> shape = Eigen::Matrix<double, 6, 1>::Zero();
  shape[0] = 0.02;
  Driven made = stranger(3);
  Observations& observations = made.run.observations;
  for (auto* planes : {&observations.ground_planes, &observations.board_planes})
    for (PlaneObservation& plane : *planes)
      if (plane.camera == 1) plane.inverse_depth_plane -= plane_by_depth_shape(plane.inverse_depth_plane) * shape;
  EXPECT_EQ(with_misplaced_depth(observations), std::vector<std::string>{observations.cameras[1].name});
}

// Clouds that a driver made with the stated lens, which is wrong, and those of one that knew the true lens. Which it
// was nobody tells, so that less is known than where depth images are given: what is stated is never too small.
TEST(MlStrangers, CloudsErrWithTheLensThatMadeThemOverTrials) {
  for (const bool by_true_lens : {false, true}) {
    double mean = 0.0;
    int suspicions = 0;
    for (int seed = 0; seed < kTrials.count(); ++seed) {
      Driven made = stranger(seed);
      Observations& observations = made.run.observations;
      for (auto* planes : {&observations.ground_planes, &observations.board_planes})
        for (PlaneObservation& plane : *planes) {
          plane.file = "cloud/000000.pcd";
          const auto c = static_cast<std::size_t>(plane.camera);
          if (by_true_lens)
            plane.inverse_depth_plane +=
                ml::Lenses(observations.cameras[c].camera).plane_by(plane.inverse_depth_plane) * made.lens[c];
        }
      const MlEstimate estimate = estimate_maximum_likelihood(observations, told());
      ASSERT_EQ(estimate.result.status, ResultStatus::kSolved) << seed;
      mean += nees(estimate, poses_of(made.run.truth)) / kTrials.count();
      for (const Finding& note : estimate.result.notes) suspicions += note.severity == Severity::kSuspect;
    }
    EXPECT_LT(mean, kUnknowns + kTrials.chi_square_tolerance(kUnknowns)) << by_true_lens;
    EXPECT_GT(mean, 0.6 * kUnknowns) << by_true_lens;
    EXPECT_EQ(suspicions, 0) << by_true_lens;
  }
}

// Of the board's size, in percent, by the data alone: nothing is believed of board and depth, and the odometry's scale
// is known to 2 %, better than ml believes. The smallest sigma that a test can have which knows all else.
double sigma_of_size_by_data(Observations observations, double* size_percent) {
  observations.board.square_sigma_m = 10.0 * observations.board.square_m;
  for (RigCamera& camera : observations.cameras) camera.depth->noise.common_scale_sigma = 10.0;
  MlOptions options = told();
  options.priors.odometry_scale = 0.02;
  const MlEstimate estimate = estimate_maximum_likelihood(observations, options);
  double sigma = 0.0;
  for (const EstimatedQuantity& quantity : estimate.result.also_estimated)
    if (quantity.name == "board_size_percent") {
      sigma = quantity.sigma;
      *size_percent = quantity.value;
    }
  return sigma;
}

// Squares that are told 3 % too large before depth that is 3 % too large: a larger world. What could contradict is seen
// at one and a half standard deviations by the most powerful test, and by nothing else: no refusal can be asked for.
TEST(MlStrangers, ASizeThatBoardAndDepthShareIsKnownByTheOdometryAlone) {
  constexpr double kLarger = 1.03;
  const Observations healthy = stranger(0).run.observations;
  Observations larger = healthy;
  larger.board.square_m *= kLarger;
  for (auto* planes : {&larger.ground_planes, &larger.board_planes})
    for (PlaneObservation& plane : *planes) {
      plane.inverse_depth_plane /= kLarger;
      plane.covariance_per_m2 /= kLarger * kLarger;
    }
  double size = 0.0, size_of_larger = 0.0;
  const double sigma = sigma_of_size_by_data(healthy, &size),
               sigma_of_larger = sigma_of_size_by_data(larger, &size_of_larger);
  EXPECT_NEAR(sigma, 2.0, 0.1);
  EXPECT_NEAR(sigma_of_larger, sigma, 0.1);
  EXPECT_NEAR(std::abs(size_of_larger - size), 3.0, 0.5);
  EXPECT_LT(std::abs(size_of_larger - size) / sigma, 1.7);
}

// A lens five percent off is beyond what its prior of half a percent allows: named, though lenses are estimated.
TEST(MlStrangers, AFocalLengthFarBeyondItsPriorIsNamed) {
  Driven made = stranger(2);
  Camera& lens = made.run.observations.cameras[1].camera;
  lens.fx_px *= 1.05;
  lens.fy_px *= 1.05;
  const MlEstimate estimate = estimate_maximum_likelihood(made.run.observations, told());
  EXPECT_NE(estimate.result.status, ResultStatus::kSolved);
  ASSERT_FALSE(estimate.contradictions.empty());
  EXPECT_EQ(estimate.contradictions.front().code, "lens.intrinsics");
}

}  // namespace
}  // namespace rigproof
