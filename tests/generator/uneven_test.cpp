// Ground that is not flat, in a run: depth shows the relief that the robot drove on, and the plane that is found in it
// is the relief's.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "driven.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/generate.h"
#include "scenario.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

GenerateConfig uneven_config(const std::string& scene, int millimetres) {
  return parse_generate_config(
      "include: plain.yaml\nscene: " + scene +
          "\nmotion: drive\nrig: husky_1x_d455\nimage_scale: 0.4\nposes: 3\nseed: 2\nsensing: {told: exact}\n"
          // A board that stands low hides much of the ground.
          "board: {place: scene}\nviewpoints: {planner: sampled}\n"
          "drive: {unevenness_mm: " +
          std::to_string(millimetres) + "}\n",
      "uneven.yaml");
}

// Depth along the optical axis at which a ray (z = 1) of the camera meets the relief, or 0.
double depth_of_relief(const GroundRelief& ground, const Rigid3& T_scene_camera, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d eye = T_scene_camera.translation, way = T_scene_camera.rotation * ray;
  if (way.z() > -0.05) return 0.0;
  double depth = -eye.z() / way.z();
  for (int i = 0; i < 20; ++i) {  // the ground is less steep than the ray
    const Eigen::Vector3d p = eye + depth * way;
    depth = (ground.height(p.head<2>()) - eye.z()) / way.z();
  }
  return depth;
}

// What the depth image of one stop says of the ground, against the relief.
struct SeenGround {
  int pixels = 0, shown = 0;                        ///< whose rays meet the ground; and those that show it
  double mean_m = 0.0;                              ///< of measured less true depth along the ray, as height
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();  ///< 1/z = plane . ray, of the true depth
};

SeenGround look(const Scenario& scenario, std::size_t stop, const Image16& depth) {
  const RigCamera& camera = scenario.rig.rig.cameras[0];
  const Rigid3 T_scene_camera = scenario.T_scene_robot[stop] * scenario.rig.T_robot_camera[0];
  const GroundRelief& ground = scenario.world->description().ground;
  SeenGround seen;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int y = 0; y < depth.height; y += 3)
    for (int x = 0; x < depth.width; x += 3) {
      Eigen::Vector3d ray;
      if (!camera.camera.unproject({x, y}, &ray)) continue;
      ray /= ray.z();
      const double z = depth_of_relief(ground, T_scene_camera, ray), measured = depth.at(x, y) * camera.depth->unit_m;
      if (z < 0.6 || z > 4.0 || measured == 0.0) continue;
      ++seen.pixels;
      if (std::abs(measured - z) > 0.05 * z) continue;
      ++seen.shown;
      seen.mean_m += (measured - z) * (T_scene_camera.rotation * ray).z();
      products += ray * ray.transpose();
      right += ray / z;
    }
  seen.mean_m /= seen.shown;
  seen.plane = products.ldlt().solve(right);
  return seen;
}

void expect_ground_is_found(const std::string& scene, int millimetres) {
  SCOPED_TRACE(scene);
  const TempFolder folder;
  GenerateOptions options;
  options.output = folder / "run";
  options.jobs = 1;
  const GenerateConfig config = uneven_config(scene, millimetres);
  const std::shared_ptr<const Scenario> scenario = prepare_generation(config, options);
  ASSERT_FALSE(scenario->world->description().ground.flat());
  ASSERT_TRUE(generate(*scenario, options).complete);
  const Recording recording = load_recording(folder / "run/recording");
  const Observations observations = observe(recording);
  ASSERT_EQ(observations.ground_planes.size(), scenario->stop_count());
  for (const PlaneObservation& found : observations.ground_planes) {
    const auto depth = read_depth_image(recording.folder / found.file);
    ASSERT_TRUE(std::holds_alternative<Image16>(depth));
    const SeenGround seen = look(*scenario, static_cast<std::size_t>(found.stop), std::get<Image16>(depth));
    EXPECT_GT(seen.shown, 0.8 * seen.pixels) << "the rest is the board, and what stands about";
    EXPECT_LT(std::abs(seen.mean_m), 0.002) << "the D455's own bias is a share of the depth";
    const Eigen::Vector3d &a = found.inverse_depth_plane, &b = seen.plane;
    EXPECT_LT(rad_to_deg(std::acos(std::min(1.0, a.normalized().dot(b.normalized())))), 1.0);
    // Height of the camera over the plane. Points that are farther from it than the sensor's noise are no inliers:
    // where waves are higher than that, one plane is as good as another within the waves.
    EXPECT_NEAR(1.0 / a.norm(), 1.0 / b.norm(), std::max(0.005, 0.001 * millimetres));
  }
}

TEST(UnevenGround, IsFoundWhereTheReliefIs) {
  expect_ground_is_found("gravel", 6);
  expect_ground_is_found("meadow", 10);
}

}  // namespace
}  // namespace rigproof
