// Robots that nobody here built: lenses, board and depth differ from what is stated by errors drawn from the usual
// priors, all at once. The stated uncertainty holds, and without the priors it does not.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"

namespace rigproof {
namespace {

const Trials kTrials(12, 60);
constexpr int kUnknowns = 18;  // of three cameras: the mean of their NEES

struct Stranger {
  GeometricRun run;
  std::vector<ml::LensChange> lens;
  Eigen::Vector4d board;
};

// The cameras and the board are other ones than the rig says.
Stranger stranger(int seed) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = 20;
  config.board_planes = true;
  Stranger made;
  const GeometricRig told = config.rig;
  RandomStream random(config.seed, "strangers");
  const IntrinsicsSigma sigma;
  const DepthNoise depth;
  const double common_depth = random.normal(0.0, depth.common_scale_sigma);
  for (RigCamera& camera : config.rig.cameras) {
    made.lens.emplace_back();
    made.lens.back() << random.normal(0.0, sigma.focal_relative), random.normal(0.0, sigma.principal_point_px),
        random.normal(0.0, sigma.principal_point_px), random.normal(0.0, sigma.focal_ratio),
        random.normal(0.0, sigma.distortion_px);
    camera.camera = ml::Lenses(camera.camera).changed(made.lens.back());
    camera.depth->noise.scale_sigma = depth.scale_sigma;
    config.depth_scales.push_back(1.0 + common_depth + random.normal(0.0, depth.scale_sigma));
  }
  Board& board = config.rig.board;
  board.square_sigma_m.reset();
  board.bow_sigma_m.reset();
  const double side = board.square_sigma_relative();
  made.board << random.normal(0.0, side), random.normal(0.0, 0.2 * side), random.normal(0.0, board.bow_sigma()),
      random.normal(0.0, board.bow_sigma());
  for (const Eigen::Vector3d& corner : board.corners()) {
    const Eigen::Vector3d p = corner - board.centre();
    const double u = 2.0 * p.x() / (board.square_m * board.squares_x),
                 v = 2.0 * p.y() / (board.square_m * board.squares_y);
    config.rig.print_errors_m.emplace_back((made.board[0] + 0.5 * made.board[1]) * p.x(),
                                           (made.board[0] - 0.5 * made.board[1]) * p.y(),
                                           made.board[2] * u * u + made.board[3] * v * v);
  }
  made.run = draw_geometric_run(config);
  Observations& observations = made.run.observations;
  observations.board = board;
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    observations.cameras[c].camera = told.cameras[c].camera;
    observations.cameras[c].intrinsics_sigma = sigma;
    observations.cameras[c].depth->noise = config.rig.cameras[c].depth->noise;
    observations.cameras[c].depth->noise.common_scale_sigma = depth.common_scale_sigma;
    // Registered depth sees through the stated lens: what it shows of a plane errs with it.
    const auto as_registered = [&](std::vector<PlaneObservation>* planes) {
      for (PlaneObservation& plane : *planes)
        if (plane.camera == static_cast<int>(c)) {
          plane.file = "depth/000000.png";
          plane.inverse_depth_plane -=
              ml::Lenses(told.cameras[c].camera).plane_by(plane.inverse_depth_plane) * made.lens[c];
        }
    };
    as_registered(&observations.ground_planes);
    as_registered(&observations.board_planes);
  }
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
    const Stranger made = stranger(seed);
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

TEST(MlStrangers, BelievedToTheLastDigitTheirErrorsShow) {
  Stranger made = stranger(0);
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

// A lens five percent off is beyond what its prior of half a percent allows: named, though lenses are estimated.
TEST(MlStrangers, AFocalLengthFarBeyondItsPriorIsNamed) {
  Stranger made = stranger(2);
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
