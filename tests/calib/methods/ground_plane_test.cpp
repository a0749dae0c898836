#include "rigproof/calib/vision/ground_plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "trials.h"
#include "worded.h"

namespace rigproof {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

struct Plane {
  Vector3d up_camera;  // unit normal towards the camera
  double distance_m;   // of the camera from it
};

// Camera 0.7 m over the floor, pitched down, rolled a little.
Plane floor_plane(double height_m = 0.7, double pitch_rad = 0.35) {
  return {Vector3d(0.05, -std::cos(pitch_rad), -std::sin(pitch_rad)).normalized(), height_m};
}

// Of the pixels that are fitted, along both axes.
constexpr int kStride = 5;

class Scene {
 public:
  explicit Scene(std::uint64_t seed) : random_(seed, "ground plane test") {
    rig_camera_.name = "left";
    rig_camera_.camera = Camera::symmetric(640, 360, 320.0);
    rig_camera_.depth = DepthStream();
  }

  DepthStream& stream() { return *rig_camera_.depth; }
  const RigCamera& camera() const { return rig_camera_; }

  // Depth of the nearest plane in each pixel, noisy in inverse depth, rounded as on disk.
  // A plane with a mask covers only the pixels for which it returns true.
  struct Surface {
    Plane plane;
    std::function<bool(int, int)> covers;
  };
  // Without noise, which is drawn in every pixel, only the pixels that fit() takes.
  Image16 render(const std::vector<Surface>& surfaces, double sigma_per_m) {
    Image16 depth(640, 360);
    const int first = sigma_per_m > 0.0 ? 0 : kStride / 2, step = sigma_per_m > 0.0 ? 1 : kStride;
    for (int y = first; y < depth.height; y += step) {
      for (int x = first; x < depth.width; x += step) {
        Vector3d ray;
        rig_camera_.camera.unproject(Eigen::Vector2d(x, y), &ray);
        double inverse = 0.0;
        for (const Surface& surface : surfaces)
          if (!surface.covers || surface.covers(x, y))
            inverse = std::max(inverse, -surface.plane.up_camera.dot(ray) / surface.plane.distance_m);
        inverse += random_.normal(0.0, sigma_per_m);
        const double counts = inverse > 0.02 ? std::round(1.0 / inverse / stream().unit_m) : 0.0;
        depth.at(x, y) = counts < 65535.0 ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
      }
    }
    return depth;
  }

 private:
  RandomStream random_;
  RigCamera rig_camera_;
};

GroundPlaneFit fit(const Scene& scene, const Image16& depth, const std::optional<Vector3d>& up = std::nullopt) {
  return fit_ground_plane(points_from_depth(depth, scene.camera(), kStride), scene.camera().depth->noise, up);
}

double angle_between(const PlaneObservation& plane, const Plane& truth) {
  return std::acos(std::min(1.0, -plane.inverse_depth_plane.normalized().dot(truth.up_camera)));
}

TEST(GroundPlane, IsExactButForTheRoundingOfDepth) {
  Scene scene(0);
  const Plane truth = floor_plane();
  const GroundPlaneFit result = fit(scene, scene.render({{truth, nullptr}}, 0.0));
  ASSERT_TRUE(result.plane) << worded(result.why_not);
  // 1 mm rounding of some 5,000 points: 0.3 mm / 70, and ten times that for what rounding has in common along rows.
  EXPECT_NEAR(height_above(*result.plane).height_m, truth.distance_m, 4e-5);
  EXPECT_LT(angle_between(*result.plane, truth), 1e-4);
}

TEST(GroundPlane, StatesAnHonestCovarianceOverTrials) {
  const Plane truth = floor_plane();
  const Vector3d a_true = -truth.up_camera / truth.distance_m;
  Vector3d bias = Vector3d::Zero();
  double nees = 0.0;
  const Trials runs(40, 150);
  for (int run = 0; run < runs.count(); ++run) {
    Scene scene(static_cast<std::uint64_t>(run));
    scene.stream().max_m = 3.0;  // cuts through the floor: the bias of the cut must not show
    const GroundPlaneFit result =
        fit(scene, scene.render({{truth, nullptr}}, scene.stream().noise.inverse_depth_sigma_per_m));
    ASSERT_TRUE(result.plane) << worded(result.why_not);
    const Vector3d error = result.plane->inverse_depth_plane - a_true;
    nees += error.dot(result.plane->covariance_per_m2.ldlt().solve(error)) / runs.count();
    bias += error.cwiseQuotient(result.plane->covariance_per_m2.diagonal().cwiseSqrt()) / runs.count();
    EXPECT_NEAR(result.plane->residual_rms, 1.0, 0.05);
  }
  // Mean of 150 chi-squares of 3 degrees: 3 +- 0.2; five of those.
  EXPECT_NEAR(nees, 3.0, runs.tolerance(1.0));
  // A mean of 150 unit normals: 0.08; four of those.
  EXPECT_LT(bias.cwiseAbs().maxCoeff(), runs.tolerance(0.33)) << bias.transpose();
}

TEST(GroundPlane, CountsCorrelatedNoiseOnceOverTrials) {
  const Plane truth = floor_plane();
  constexpr int kBlock = 20;
  double nees = 0.0;
  const Trials runs(20, 60);
  for (int run = 0; run < runs.count(); ++run) {
    Scene scene(0);
    RandomStream random(static_cast<std::uint64_t>(run), "blocks");
    Image16 depth(640, 360);
    std::vector<double> noise(32 * 18);
    for (double& value : noise) value = random.normal(0.0, 0.0019);
    for (int y = 0; y < 360; ++y) {
      for (int x = 0; x < 640; ++x) {
        Vector3d ray;
        scene.camera().camera.unproject(Eigen::Vector2d(x, y), &ray);
        const double inverse = -truth.up_camera.dot(ray) / truth.distance_m +
                               noise[static_cast<std::size_t>(y / kBlock * 32 + x / kBlock)];
        if (inverse > 0.17) depth.at(x, y) = static_cast<std::uint16_t>(std::lround(1000.0 / inverse));
      }
    }
    const GroundPlaneFit result =
        fit_ground_plane(points_from_depth(depth, scene.camera(), kStride), scene.camera().depth->noise, std::nullopt);
    ASSERT_TRUE(result.plane) << worded(result.why_not);
    const Vector3d error = result.plane->inverse_depth_plane + truth.up_camera / truth.distance_m;
    nees += error.dot(result.plane->covariance_per_m2.ldlt().solve(error)) / runs.count();
    // 4 x 4 points of the grid share one value.
    EXPECT_LT(result.plane->effective_points, result.plane->inlier_points / 8.0);
  }
  // Counting every point would give 48; the measured correlation may be off by half.
  EXPECT_GT(nees, 1.0);
  EXPECT_LT(nees, 6.0);
}

TEST(GroundPlane, PrefersTheFloorToALargerWall) {
  Scene scene(1);
  const Plane floor = floor_plane(), wall{Vector3d(0.0, 0.0, -1.0), 1.9};
  const Image16 depth = scene.render({{floor, nullptr}, {wall, nullptr}}, 0.0019);
  for (const std::optional<Vector3d>& up : {std::optional<Vector3d>(), std::optional<Vector3d>(floor.up_camera)}) {
    const GroundPlaneFit result = fit(scene, depth, up);
    ASSERT_TRUE(result.plane) << worded(result.why_not);
    EXPECT_LT(angle_between(*result.plane, floor), deg_to_rad(0.3));
    EXPECT_NEAR(height_above(*result.plane).height_m, 0.7, 0.005);
  }
}

TEST(GroundPlane, TakesTheFloorBelowALargerTable) {
  Scene scene(2);
  const Plane floor = floor_plane(1.2), table = floor_plane(0.5);
  const Image16 depth = scene.render({{floor, nullptr}, {table, [](int x, int) { return x < 420; }}}, 0.0019);
  const GroundPlaneFit result = fit(scene, depth, floor.up_camera);
  ASSERT_TRUE(result.plane) << worded(result.why_not);
  EXPECT_NEAR(height_above(*result.plane).height_m, 1.2, 0.01);
}

// The robot's own deck fills the lower part of every image; of the floor beyond it little is in range.
TEST(GroundPlane, TakesNoDeckThatMostIsSeenPast) {
  Scene scene(6);
  scene.stream().max_m = 3.0;
  const Plane floor = floor_plane(0.6, 0.1), deck = floor_plane(0.2, 0.1);
  const auto on_deck = [](int, int y) { return y > 240; };
  const GroundPlaneFit beyond = fit(scene, scene.render({{floor, nullptr}, {deck, on_deck}}, 0.0019), floor.up_camera);
  ASSERT_TRUE(beyond.plane) << worded(beyond.why_not);
  EXPECT_NEAR(height_above(*beyond.plane).height_m, 0.6, 0.02);
  // A wall hides the floor: what is seen past the deck is no plane that could be it.
  const Plane wall{Vector3d(0.0, 0.0, -1.0), 1.5};
  const GroundPlaneFit none = fit(scene, scene.render({{wall, nullptr}, {deck, on_deck}}, 0.0019), floor.up_camera);
  EXPECT_FALSE(none.plane);
  EXPECT_THAT(worded(none.why_not), HasSubstr("is not the ground: much is seen past it (0.20 m below the camera"));
}

TEST(GroundPlane, FindsTheFloorOfACameraThatHangsUpsideDown) {
  Scene scene(3);
  Plane floor = floor_plane();
  floor.up_camera.y() *= -1.0;
  const Plane ceiling{-floor.up_camera, 1.8};
  const GroundPlaneFit result =
      fit(scene, scene.render({{floor, nullptr}, {ceiling, nullptr}}, 0.0019), floor.up_camera);
  ASSERT_TRUE(result.plane) << worded(result.why_not);
  EXPECT_LT(angle_between(*result.plane, floor), deg_to_rad(0.3));
}

TEST(GroundPlane, SaysWhyThereIsNone) {
  Scene scene(4);
  const GroundPlaneFit empty = fit(scene, Image16(640, 360));
  EXPECT_FALSE(empty.plane);
  EXPECT_THAT(worded(empty.why_not), HasSubstr("only 0 points"));
  const Plane far{Vector3d(0.0, 0.0, -1.0), 20.0};
  const GroundPlaneFit far_away = fit(scene, scene.render({{far, nullptr}}, 0.0));
  EXPECT_THAT(worded(far_away.why_not), HasSubstr("m; the image holds 20.00 to 20.00 m)"));
  const Plane wall{Vector3d(0.0, 0.0, -1.0), 1.5};
  const GroundPlaneFit only_wall = fit(scene, scene.render({{wall, nullptr}}, 0.0019), Vector3d(0.0, -1.0, 0.0));
  EXPECT_FALSE(only_wall.plane);
  EXPECT_THAT(worded(only_wall.why_not), HasSubstr("no plane is level"));
}

TEST(GroundPlane, GivesTheSameBytesTwice) {
  Scene scene(5);
  const Image16 depth = scene.render({{floor_plane(), nullptr}}, 0.0019);
  const GroundPlaneFit first = fit(scene, depth), second = fit(scene, depth);
  ASSERT_TRUE(first.plane && second.plane);
  EXPECT_EQ(first.plane->inverse_depth_plane, second.plane->inverse_depth_plane);
}

TEST(PointsFromDepth, RefusesAnotherSizeAndAMissingStream) {
  Scene scene(6);
  EXPECT_THROW(points_from_depth(Image16(10, 10), scene.camera(), 1), Error);
  RigCamera colour_only = scene.camera();
  colour_only.depth.reset();
  EXPECT_THROW(points_from_depth(Image16(640, 360), colour_only, 1), Error);
}

TEST(PointsFromDepth, MovesPointsOfAnOwnDepthCameraToTheColourFrame) {
  RigCamera camera;
  camera.camera = Camera::symmetric(640, 480, 500.0);
  camera.depth = DepthStream();
  camera.depth->own_camera = DepthStream::OwnCamera{Camera::symmetric(5, 5, 3.0),
                                                    Rigid3(Eigen::Quaterniond::Identity(), Vector3d(0.06, 0.0, 0.01))};
  Image16 depth(5, 5);
  depth.at(2, 2) = 1500;
  const DepthPoints points = points_from_depth(depth, camera, 1);
  ASSERT_EQ(points.points.size(), 1u);
  // Single precision.
  EXPECT_LT((points.points[0] - Eigen::Vector3f(0.06F, 0.0F, 1.51F)).norm(), 1e-6F);
}

// Squared error of a fitted plane over what it states, a dimension.
double squared_sigmas(const PlaneObservation& plane, const Plane& truth) {
  const Vector3d error = plane.inverse_depth_plane + truth.up_camera / truth.distance_m;
  return error.dot(plane.covariance_per_m2.ldlt().solve(error)) / 3.0;
}

// Without noise neighbouring pixels are rounded alike, in a level camera whole rows: 7,000 points are not 7,000
// measurements.
TEST(GroundPlane, RoundingAloneIsStatedAsLargeAsItIs) {
  for (const double roll : {0.0, 0.05}) {
    double sum = 0.0;
    constexpr int kHeights = 30;
    for (int i = 0; i < kHeights; ++i) {
      Scene scene(1);
      Plane floor = floor_plane(0.65 + 0.0037 * i);
      floor.up_camera = Vector3d(roll, -std::cos(0.35), -std::sin(0.35)).normalized();
      const GroundPlaneFit found = fit(scene, scene.render({{floor, nullptr}}, 0.0), floor.up_camera);
      ASSERT_TRUE(found.plane) << worded(found.why_not);
      sum += squared_sigmas(*found.plane, floor) / kHeights;
    }
    // One is expected; 90 dimensions, of which neighbouring heights share some.
    EXPECT_GT(sum, 0.4) << "roll " << roll;
    EXPECT_LT(sum, 1.8) << "roll " << roll;
  }
}

}  // namespace
}  // namespace rigproof
