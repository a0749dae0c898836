#include "rigproof/sim/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "error_text.h"
#include "process.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

WorldDescription small_world(Lens lens = Lens::kPinhole) {
  const SceneModel scene = load_scene_model("indoor_lab");
  const RigModel rig = load_rig_model("husky_1x_d455");
  WorldDescription description =
      describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 3);
  Camera camera = Camera::symmetric(320, 240, 200.0);
  camera.lens = lens;
  if (lens == Lens::kBrownConrady) camera.distortion = {-0.05, 0.01, 0.001, -0.001, 0.0};
  description.cameras[0].camera = camera;
  return description;
}

// The lab's board fills a good part of the picture from here.
Rigid3 before_the_board() { return planar_pose(2.4, 0.0, 0.0); }

RenderedView render_once(const WorldDescription& description, const RenderOptions& options) {
  const auto world = World::compose(description);
  world->place_robot(before_the_board());
  Renderer renderer(*world, options);
  RenderedView view;
  renderer.render(0, &view);
  return view;
}

std::size_t count_kind(const World& world, const Image16& ids, ObjectKind kind) {
  std::size_t count = 0;
  for (const std::uint16_t id : ids.pixels) count += world.kind_of_object(id) == kind ? 1U : 0U;
  return count;
}

TEST(Renderer, SeesFloorBoardAndSceneButNotTheRobot) {
  const auto world = World::compose(small_world());
  world->place_robot(before_the_board());
  RenderOptions options;
  options.object_ids = true;
  Renderer renderer(*world, options);
  RenderedView view;
  renderer.render(0, &view);
  EXPECT_GT(count_kind(*world, view.object_ids, ObjectKind::kFloor), 10000U);
  EXPECT_GT(count_kind(*world, view.object_ids, ObjectKind::kBoard), 1000U);
  EXPECT_GT(count_kind(*world, view.object_ids, ObjectKind::kScene), 5000U);
  EXPECT_EQ(count_kind(*world, view.object_ids, ObjectKind::kRobot), 0U);
  EXPECT_EQ(view.color.channels, 3);
  EXPECT_EQ(view.color.width, 320);
  EXPECT_EQ(view.depth_m.height, 240);
  EXPECT_THAT(renderer.gl_renderer(), testing::Not(testing::IsEmpty()));
}

TEST(Renderer, DepthAgreesWithRays) {
  const WorldDescription description = small_world(Lens::kBrownConrady);
  const auto world = World::compose(description);
  world->place_robot(before_the_board());
  Renderer renderer(*world, RenderOptions());
  RenderedView view;
  renderer.render(0, &view);
  const Rigid3 T_world_camera = world->T_world_camera(0);
  int compared = 0, apart = 0;
  for (int y = 10; y < 230; y += 10) {
    for (int x = 10; x < 310; x += 10) {
      Eigen::Vector3d ray;
      ASSERT_TRUE(description.cameras[0].camera.unproject({x, y}, &ray));
      const double distance = world->cast_ray(T_world_camera.translation, T_world_camera.rotation * ray);
      const double depth = distance / ray.norm();
      if (!(depth < 15.0)) continue;
      ++compared;
      apart += std::abs(depth - static_cast<double>(view.depth_m.at(x, y))) > 2e-3 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 500);
  EXPECT_LE(apart, compared / 50);  // rays that graze an edge may meet either side of it
}

TEST(Renderer, OnlyWhatIsAskedForIsRendered) {
  RenderOptions options;
  options.color = false;
  const RenderedView depth_only = render_once(small_world(), options);
  EXPECT_TRUE(depth_only.color.empty());
  EXPECT_FALSE(depth_only.depth_m.empty());
  EXPECT_TRUE(depth_only.object_ids.empty());
  options.color = true;
  options.depth = false;
  const RenderedView color_only = render_once(small_world(), options);
  EXPECT_FALSE(color_only.color.empty());
  EXPECT_TRUE(color_only.depth_m.empty());
}

TEST(Renderer, RepeatsAreBitIdentical) {
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady}) {
    const auto world = World::compose(small_world(lens));
    world->place_robot(before_the_board());
    RenderOptions options;
    options.object_ids = true;
    Renderer renderer(*world, options);
    RenderedView first, again;
    renderer.render(0, &first);
    world->place_robot(planar_pose(-1.0, 1.0, 2.0));
    renderer.render(0, &again);
    EXPECT_NE(first.color.pixels, again.color.pixels);
    world->place_robot(before_the_board());
    renderer.render(0, &again);
    EXPECT_EQ(first.color.pixels, again.color.pixels);
    EXPECT_EQ(first.depth_m.pixels, again.depth_m.pixels);
    EXPECT_EQ(first.object_ids.pixels, again.object_ids.pixels);
  }
}

TEST(Renderer, TwoProcessesAgreeWhateverTheirThreads) {
  const ProcessOutput one = run_process({"/usr/bin/env", "LP_NUM_THREADS=1", RIGPROOF_RENDER_HASH});
  const ProcessOutput other = run_process({"/usr/bin/env", "LP_NUM_THREADS=2", RIGPROOF_RENDER_HASH});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_EQ(one.out.size(), 65U);  // a SHA-256 and a line end
  EXPECT_EQ(one.out, other.out);
}

TEST(Renderer, SeedChangesTheTextures) {
  WorldDescription description = small_world();
  const RenderedView first = render_once(description, RenderOptions());
  description.scene_seed = 4;
  const RenderedView other = render_once(description, RenderOptions());
  EXPECT_NE(first.color.pixels, other.color.pixels);
  EXPECT_EQ(first.depth_m.pixels, other.depth_m.pixels);
}

TEST(Renderer, DoubleResolutionOfTheBoardEqualsThatOfTheWholeFrameThere) {
  RenderOptions options;
  const RenderedView board = render_once(small_world(), options);
  options.whole_at_double = true;
  const RenderedView whole = render_once(small_world(), options);
  const WorldDescription description = small_world();
  const auto world = World::compose(description);
  world->place_robot(before_the_board());
  Eigen::Vector2d pixel;
  ASSERT_TRUE(description.cameras[0].camera.project(
      world->T_world_camera(0).inverse() * (description.T_world_board * description.board.centre()), &pixel));
  int worst = 0;
  for (int y = -5; y <= 5; ++y)
    for (int x = -5; x <= 5; ++x) {
      const int u = static_cast<int>(pixel.x()) + x, v = static_cast<int>(pixel.y()) + y;
      worst = std::max(worst, std::abs(board.color.at(u, v) - whole.color.at(u, v)));
    }
  EXPECT_LE(worst, 2);  // grey levels: the two frusta sample the texture at positions that differ by rounding
}

TEST(Renderer, SkyHasColourAndNoDepth) {
  WorldDescription description = small_world();
  description.scene = load_scene_model("outdoor_yard").world;
  const auto world = World::compose(description);
  Renderer renderer(*world, RenderOptions());
  RenderedView view;
  const Rigid3 up = mount_pose(0.0, 0.0, 1.0, 0.0, -60.0, 0.0);
  renderer.render_from(up, description.cameras[0].camera, true, &view);
  EXPECT_EQ(view.depth_m.at(160, 5), 0.0F);
  EXPECT_GT(view.color.at(160, 5, 2), view.color.at(160, 5, 0));  // blue
}

TEST(RendererErrors, NoEglSaysWhatToInstall) {
  ASSERT_EQ(setenv("RIGPROOF_LIBEGL", "libEGL_not_there.so", 1), 0);
  std::string problem;
  EXPECT_TRUE(enumerate_render_devices(&problem).empty());
  EXPECT_THAT(problem, AllOf(HasSubstr("libEGL_not_there.so"), HasSubstr("apt-get install libegl1 libgl1-mesa-dri")));
  const auto world = World::compose(small_world());
  EXPECT_THROW(Renderer(*world, RenderOptions()), Error);
  // A library that is not EGL at all.
  ASSERT_EQ(setenv("RIGPROOF_LIBEGL", "libm.so.6", 1), 0);
  EXPECT_TRUE(enumerate_render_devices(&problem).empty());
  EXPECT_THAT(problem, HasSubstr("not a usable EGL library"));
  unsetenv("RIGPROOF_LIBEGL");
  EXPECT_FALSE(enumerate_render_devices(&problem).empty());
  EXPECT_EQ(problem, "");
}

TEST(RendererErrors, UnknownDeviceNamesThoseThatExist) {
  const auto world = World::compose(small_world());
  RenderOptions options;
  options.device = 77;
  EXPECT_THAT(error_text([&] { Renderer renderer(*world, options); }), AllOf(HasSubstr("77"), HasSubstr("-1")));
}

TEST(RendererErrors, ImpossibleCameras) {
  WorldDescription description = small_world();
  description.cameras[0].camera.fx_px = 0.0;
  EXPECT_THROW(render_once(description, RenderOptions()), Error);
  description = small_world(Lens::kKannalaBrandt);
  description.cameras[0].camera.fx_px = description.cameras[0].camera.fy_px = 100.0;  // 184 degrees wide
  EXPECT_THAT(error_text([&] { render_once(description, RenderOptions()); }),
              AllOf(HasSubstr("front"), HasSubstr("150 degrees")));
  RenderOptions options;
  options.psf_sigma_px = -1.0;
  EXPECT_THROW(render_once(small_world(), options), Error);
}

}  // namespace
}  // namespace rigproof
