// The floor under a plate in the sun, seen from the side: dark where the geometry says, light elsewhere, and what
// stands above the floor keeps its light.
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/renderer.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

// The sun stands 45 degrees high behind -x: shadows fall to +x by as much as a thing is high.
constexpr const char* kPlate =
    "<mujoco><worldbody><light directional=\"true\" dir=\"1 0 -1\" castshadow=\"true\" diffuse=\".6 .6 .6\" "
    "ambient=\".3 .3 .3\" specular=\"0 0 0\"/><geom name=\"floor\" type=\"plane\" size=\"9 9 1\" rgba=\".8 .8 .8 1\"/>"
    "<geom type=\"box\" pos=\"0 2 1\" size=\".5 .5 .01\" rgba=\".8 .8 .8 1\"/></worldbody></mujoco>";

class SunShadowsTest : public testing::Test {
 protected:
  // Brightness of the floor at a place, seen from above and aside.
  void render(bool shadows) {
    folder_.write("plate.xml", kPlate);
    folder_.write("plate.yaml",
                  "mjcf: plate.xml\ndrivable_area: {x_min_m: -3, x_max_m: 3, y_min_m: -3, y_max_m: 3}\n"
                  "board: {x_m: 8}\nshadows: " +
                      std::string(shadows ? "true" : "false") + "\n");
    const SceneModel scene = load_scene_model((folder_ / "plate.yaml").string());
    const RigModel rig = load_rig_model("husky_1x_d455");
    const auto world =
        World::compose(describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0));
    world->place_robot(planar_pose(0.0, -2.0, 0.0));
    RenderOptions options;
    options.psf_sigma_px = 0.0;
    Renderer renderer(*world, options);
    renderer.render_from(T_world_camera_, camera_, true, &view_);
  }
  int brightness(double x, double y, double z = 0.0) const {
    Eigen::Vector2d pixel;
    EXPECT_TRUE(camera_.project(T_world_camera_.inverse() * Eigen::Vector3d(x, y, z), &pixel));
    return view_.color.at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  }

  TempFolder folder_;
  Camera camera_ = Camera::symmetric(640, 480, 300.0);
  Rigid3 T_world_camera_ = mount_pose(4.0, 0.5, 4.0, 0.0, 45.0, 180.0);
  RenderedView view_;
};

TEST_F(SunShadowsTest, FallWhereTheGeometrySays) {
  render(true);
  const int light = brightness(2.5, 0.5), dark = brightness(1.0, 2.0);
  // Of ambient .3 and .6 sin 45 deg of sun the ambient is left; a level for rounding, another for the blur.
  EXPECT_NEAR(dark, light * 0.3 / (0.3 + 0.6 * std::sqrt(0.5)), 2.0);
  for (const double off : {0.4, -0.4}) {
    EXPECT_NEAR(brightness(1.0 + off, 2.0), dark, 2.0);
    EXPECT_NEAR(brightness(1.0, 2.0 + off), dark, 2.0);
  }
  for (const double off : {0.6, -0.6}) {
    EXPECT_NEAR(brightness(1.0 + off, 2.0), light, 2.0);
    EXPECT_NEAR(brightness(1.0, 2.0 + off), light, 2.0);
  }
  EXPECT_NEAR(brightness(0.0, 2.0, 1.01), light, 2.0) << "the plate itself";
  EXPECT_LT(brightness(0.65, -2.0), light - 20) << "the robot has a shadow, too";
}

TEST_F(SunShadowsTest, AreLeftOutUnlessAskedFor) {
  render(false);
  EXPECT_EQ(brightness(1.0, 2.0), brightness(2.5, 0.5));
}

}  // namespace
}  // namespace rigproof
