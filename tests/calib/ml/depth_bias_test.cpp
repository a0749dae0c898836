// A depth sensor's fixed, smooth error over its view: drawn, given to floors and boards, and told or not.
#include "rigproof/calib/estimate/depth_bias.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "calibration_truth.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/methods/memroc.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"
#include "trials.h"

namespace rigproof {
namespace {

constexpr double kBias_per_m = 0.002;  // as large as the noise of one point: 0.7 mm at 0.6 m
constexpr double kCell_deg = 15.0;

// A Gaussian process over the image by random waves, made without the code under test.
class DrawnBias {
 public:
  DrawnBias(const Camera& camera, std::uint64_t seed, int index) : camera_(camera) {
    RandomStream random(seed, "depth bias of a test", -1, index);
    const double length_px = 0.816 * camera.fx_px * std::tan(deg_to_rad(kCell_deg));
    for (Wave& wave : waves_)
      wave = {{random.normal() / length_px, random.normal() / length_px}, random.uniform(0.0, 2.0 * kPi)};
  }

  double at(const Eigen::Vector2d& pixel) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::cos(wave.frequency.dot(pixel) + wave.phase);
    return kBias_per_m * sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  }

  // What it adds to a plane that is fitted at these pixels.
  Eigen::Vector3d on_plane(const std::vector<Eigen::Vector2d>& pixels) const {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector2d& pixel : pixels) {
      Eigen::Vector3d ray;
      if (!camera_.unproject(pixel, &ray)) continue;
      information += ray * ray.transpose();
      sum += at(pixel) * ray;
    }
    return information.ldlt().solve(sum);
  }

  // Where the image shows the floor within the sensor's reach.
  std::vector<Eigen::Vector2d> floor_pixels(const Eigen::Vector3d& plane, const DepthStream& depth) const {
    std::vector<Eigen::Vector2d> pixels;
    for (int y = 0; y < camera_.height_px; y += 40)
      for (int x = 0; x < camera_.width_px; x += 40) {
        Eigen::Vector3d ray;
        if (!camera_.unproject(Eigen::Vector2d(x, y), &ray)) continue;
        const double depth_m = 1.0 / plane.dot(ray);
        if (depth_m >= depth.min_m && depth_m <= depth.max_m) pixels.emplace_back(x, y);
      }
    return pixels;
  }

 private:
  struct Wave {
    Eigen::Vector2d frequency;
    double phase;
  };
  const Camera camera_;
  std::array<Wave, 200> waves_;
};

GeometricRun run_with_bias(std::uint64_t seed, bool told, int stops = 20, bool at_one_place = false) {
  GeometricConfig config;
  if (at_one_place) {
    config.rig.min_distance_m = 1.8;
    config.rig.max_distance_m = 2.2;
    config.rig.max_aim_error_rad = 0.05;
  }
  config.seed = seed;
  config.stops = stops;
  config.lambda = 0.0;
  config.board_planes = true;
  config.depth_scale_sigma = 0.003;
  GeometricRun run = draw_geometric_run(config);
  Observations& observations = run.observations;
  std::vector<DrawnBias> drawn;
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    RigCamera& camera = observations.cameras[c];
    drawn.emplace_back(camera.camera, seed, static_cast<int>(c));
    camera.depth->noise.bias_inverse_depth_per_m = told ? kBias_per_m : 0.0;
    camera.depth->noise.bias_cell_deg = kCell_deg;
  }
  std::vector<std::optional<Eigen::Vector3d>> of_floor(drawn.size());  // the same at every stop
  for (PlaneObservation& plane : observations.ground_planes) {
    const auto c = static_cast<std::size_t>(plane.camera);
    if (!of_floor[c])
      of_floor[c] = drawn[c].on_plane(drawn[c].floor_pixels(plane.inverse_depth_plane, *observations.cameras[c].depth));
    plane.inverse_depth_plane += *of_floor[c];
  }
  for (PlaneObservation& plane : observations.board_planes)
    for (const BoardView& view : observations.board_views) {
      if (view.stop != plane.stop || view.camera != plane.camera) continue;
      std::vector<Eigen::Vector2d> pixels;
      for (const CornerObservation& corner : view.corners) pixels.push_back(corner.pixel);
      plane.inverse_depth_plane += drawn[static_cast<std::size_t>(plane.camera)].on_plane(pixels);
    }
  return run;
}

MlOptions told_options() {
  MlOptions options;
  options.suspension_height_sigma_m = options.suspension_tilt_sigma_rad = 0.0;
  return options;
}

TEST(DepthBias, ToldItIsInTheUncertaintyOverTrials) {
  const Trials trials(10, 40);
  double mean = 0.0, height_square = 0.0;
  for (int seed = 0; seed < trials.count(); ++seed) {
    const GeometricRun run = run_with_bias(static_cast<std::uint64_t>(seed), true);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told_options());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    mean += nees(estimate, poses_of(run.truth)) / trials.count();
    for (std::size_t c = 0; c < run.truth.cameras.size(); ++c) {
      const auto z = 6 * static_cast<Eigen::Index>(c) + 2;
      const double error =
          estimate.state.T_robot_camera[c].translation.z() - run.truth.cameras[c].T_robot_camera.translation.z();
      height_square += error * error / (*estimate.result.joint_covariance)(z, z) / (3.0 * trials.count());
    }
  }
  EXPECT_NEAR(mean, 18.0, trials.chi_square_tolerance(18));
  EXPECT_NEAR(height_square, 1.0, trials.chi_square_tolerance(3) / 3.0) << "the heights alone, of three cameras";
}

TEST(DepthBias, UntoldItMakesHeightsSilentlyWrong) {
  double mean = 0.0;
  constexpr int kTrials = 5;
  for (int seed = 0; seed < kTrials; ++seed) {
    const GeometricRun run = run_with_bias(static_cast<std::uint64_t>(seed), false);
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told_options());
    if (estimate.result.joint_covariance) mean += nees(estimate, poses_of(run.truth)) / kTrials;
  }
  EXPECT_GT(mean, 60.0);
}

TEST(DepthBias, OfFloorsIsWhatDrawnOnesDoOverTrials) {
  const Trials trials(60, 300);
  const GeometricRun run = run_with_bias(1, true);
  const std::vector<Eigen::Matrix3d> stated = ground_plane_biases(run.observations);
  ASSERT_EQ(stated.size(), 3U);
  const RigCamera& camera = run.observations.cameras[0];
  const PlaneObservation* floor = nullptr;
  for (const PlaneObservation& plane : run.observations.ground_planes)
    if (plane.camera == 0) floor = &plane;
  ASSERT_NE(floor, nullptr);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (int i = 0; i < trials.count(); ++i) {
    const DrawnBias bias(camera.camera, static_cast<std::uint64_t>(i), 7);
    const Eigen::Vector3d error = bias.on_plane(bias.floor_pixels(floor->inverse_depth_plane, *camera.depth));
    scatter += error * error.transpose() / trials.count();
  }
  const Eigen::Vector3d ratio = scatter.diagonal().cwiseQuotient(stated[0].diagonal());
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(ratio[axis], 1.0, trials.chi_square_tolerance(1)) << "axis " << axis;
}

std::vector<Eigen::Vector2d> corners_at(const Observations& observations, const PlaneObservation& plane) {
  std::vector<Eigen::Vector2d> pixels;
  for (const BoardView& view : observations.board_views)
    if (view.stop == plane.stop && view.camera == plane.camera)
      for (const CornerObservation& corner : view.corners) pixels.push_back(corner.pixel);
  return pixels;
}

// A sum over boards all over the image: they share the field, so that the mean of many is not much better than one.
// All are drawn everywhere, sanitized, too: it takes a moment, and the lower bound needs them.
TEST(DepthBias, OfASumOfBoardsIsWhatDrawnOnesDo) {
  constexpr int kDrawn = 300;
  const GeometricRun run = run_with_bias(1, true);
  const std::vector<PlaneObservation>& planes = run.observations.board_planes;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero(), alone = Eigen::Matrix3d::Zero(), stated = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDrawn; ++i) {
    const DrawnBias bias(run.observations.cameras[0].camera, static_cast<std::uint64_t>(i), 7);
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    for (const PlaneObservation& plane : planes)
      if (plane.camera == 0) error += bias.on_plane(corners_at(run.observations, plane));
    scatter += error * error.transpose() / kDrawn;
  }
  const std::vector<Eigen::Matrix3d> of_each = board_plane_biases(run.observations),
                                     lasting = lasting_board_plane_biases(run.observations);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].camera != 0) continue;
    alone += of_each[i];
    stated += lasting[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double of_stated = scatter(axis, axis) / stated(axis, axis);
    EXPECT_LT(of_stated, 1.0 + 3.0 * std::sqrt(2.0 / kDrawn)) << "axis " << axis;
    EXPECT_GT(of_stated, 0.25) << "a tilt differs sooner from place to place than what is between: " << axis;
    EXPECT_GT(scatter(axis, axis), 2.0 * alone(axis, axis)) << "axis " << axis;
  }
}

// The part of the field that all boards share does not average out, and they do not scatter by it: a level of the
// planes' noise below one would believe it away.
TEST(DepthBias, OfBoardsAtOnePlaceDoesNotAverageOut) {
  GeometricRun run = run_with_bias(1, true);
  Observations& observations = run.observations;
  const auto largest_factor = [&observations] {
    const std::vector<Eigen::Matrix3d> each = board_plane_biases(observations),
                                       lasting = lasting_board_plane_biases(observations);
    double largest = 0.0;
    for (std::size_t i = 0; i < each.size(); ++i)
      if (observations.board_planes[i].camera == 0) largest = std::max(largest, lasting[i].trace() / each[i].trace());
    return largest;
  };
  const double spread = largest_factor();
  int planes = 0;
  const BoardView* first = nullptr;
  for (BoardView& view : observations.board_views) {
    if (view.camera != 0) continue;
    if (first == nullptr) first = &view;
    view.corners = first->corners;
    ++planes;
  }
  EXPECT_GT(spread, 1.5);
  EXPECT_LT(spread, 0.9 * planes);
  EXPECT_NEAR(largest_factor(), planes, 1e-9);
}

TEST(DepthBias, IsInTheUncertaintyWhereBoardsStayAtOnePlaceOverTrials) {
  const Trials trials(6, 30);
  double mean = 0.0;
  for (int seed = 0; seed < trials.count(); ++seed) {
    GeometricRun run = run_with_bias(static_cast<std::uint64_t>(seed), true, 60, true);
    for (RigCamera& camera : run.observations.cameras) {
      camera.intrinsics_sigma = IntrinsicsSigma();
      camera.intrinsics_sigma.residual_px = 0.0;
    }
    const MlEstimate estimate = estimate_maximum_likelihood(run.observations, told_options());
    ASSERT_TRUE(estimate.result.joint_covariance) << seed;
    for (const double scale : estimate.board_plane_scale) EXPECT_GE(scale, 1.0);
    mean += nees(estimate, poses_of(run.truth)) / trials.count();
  }
  EXPECT_LT(mean, 18.0 + trials.chi_square_tolerance(18));
}

TEST(DepthBias, IsTakenForNoShapeOverTrials) {
  for (int seed = 0; seed < Trials(10, 40).count(); ++seed) {
    const GeometricRun run = run_with_bias(static_cast<std::uint64_t>(seed), true, 40, seed % 2 == 1);
    for (const Finding& note : estimate_maximum_likelihood(run.observations, told_options()).result.notes)
      EXPECT_FALSE(note.is("depth.misplaced")) << seed;
  }
}

TEST(DepthBias, IsInTheHeightOfMemrocToo) {
  const auto height_sigma = [](bool told) {
    const GeometricRun run = run_with_bias(1, told);
    const Result result = solve_memroc(run.observations, estimate_view_poses(run.observations), MemrocOptions());
    return std::sqrt(result.camera_to_robot.at(0).covariance.value()(2, 2));
  };
  EXPECT_GT(height_sigma(true), 0.3e-3);
  EXPECT_LT(height_sigma(false), height_sigma(true));
}

TEST(DepthBias, WithoutOneNothingIsAdded) {
  const GeometricRun run = run_with_bias(1, false);
  EXPECT_TRUE(ground_plane_biases(run.observations).empty());
  EXPECT_TRUE(board_plane_biases(run.observations).empty());
  EXPECT_THAT(relative_height_biases(run.observations), testing::Each(0.0));
}

}  // namespace
}  // namespace rigproof
