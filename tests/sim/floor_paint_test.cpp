// Rugs and lines are seen but have the floor's depth; what is thicker keeps its own.
#include "floor_paint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "depth.h"
#include "render_truth.h"
#include "rigproof/core/conventions.h"
#include "rigproof/sim/models.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

// Half of what is seen is a rug of 0.1 mm; beside it lies a mat of 5 mm.
constexpr const char* kRoom =
    "<mujoco><worldbody><light directional=\"true\" dir=\"0 0 -1\"/>"
    "<geom name=\"floor\" type=\"plane\" size=\"9 9 1\" rgba=\".8 .8 .8 1\"/>"
    "<geom name=\"floor_rug\" type=\"box\" pos=\"1 0 0\" size=\"1 3 .0001\" rgba=\".6 .1 .1 1\" contype=\"0\" "
    "conaffinity=\"0\"/>"
    "<geom name=\"mat\" type=\"box\" pos=\"1.5 1 0\" size=\".2 .2 .005\" rgba=\".1 .1 .6 1\"/></worldbody></mujoco>";

class FloorPaintTest : public testing::Test {
 protected:
  void render(const Camera& camera) {
    folder_.write("room.xml", kRoom);
    folder_.write("room.yaml",
                  "mjcf: room.xml\ndrivable_area: {x_min_m: -3, x_max_m: 3, y_min_m: -3, y_max_m: 3}\n"
                  "board: {x_m: 8}\n");
    const SceneModel scene = load_scene_model((folder_ / "room.yaml").string());
    const RigModel rig = load_rig_model("husky_1x_d455");
    world_ =
        World::compose(describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0));
    world_->place_robot(planar_pose(0.0, -2.0, 0.0));
    RenderOptions options;
    options.object_ids = true;
    Renderer(*world_, options).render_from(T_world_camera_, camera, true, &view_);
  }
  Eigen::Vector3d seen_at(const Camera& camera, const Eigen::Vector3d& place) const {
    Eigen::Vector2d pixel;
    Eigen::Vector3d ray;
    EXPECT_TRUE(camera.project(T_world_camera_.inverse() * place, &pixel));
    const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
    EXPECT_TRUE(camera.unproject({x, y}, &ray));
    return T_world_camera_ * (static_cast<double>(view_.depth_m.at(x, y)) * ray);
  }

  TempFolder folder_;
  std::unique_ptr<World> world_;
  Rigid3 T_world_camera_ = mount_pose(-0.8, 0.3, 0.7, 2.0, 25.0, 3.0);
  RenderedView view_;
};

TEST_F(FloorPaintTest, ARugHasTheDepthOfTheFloor) {
  for (const WorldCamera& camera : figure_cameras()) {
    render(camera.camera);
    DepthStatistics floor;
    add_plane_depth(*world_, view_, ObjectKind::kFloor, camera.camera, T_world_camera_.inverse(), boundless(), &floor);
    ASSERT_GT(floor.pixels, 200000U) << camera.name;
    EXPECT_LE(floor.largest_m, 1e-5) << camera.name;
    EXPECT_NEAR(seen_at(camera.camera, {1.5, 1.0, 0.005}).z(), 0.005, 1e-4) << camera.name << ": a mat is no paint";
  }
}

TEST_F(FloorPaintTest, ARugIsSeen) {
  const Camera camera = figure_cameras()[0].camera;
  render(camera);
  Eigen::Vector2d pixel;
  ASSERT_TRUE(camera.project(T_world_camera_.inverse() * Eigen::Vector3d(1.0, -0.5, 0.0), &pixel));
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  EXPECT_GT(view_.color.at(x, y, 0), 3 * view_.color.at(x, y, 1)) << "red";
}

// One column of depths, looking down from 1 m: heights above the floor of a picture that nobody drew.
TEST(FloorPaint, GoesByHeight) {
  const mujoco::DepthLaw law = mujoco::depth_law(0.35, 60.0);
  const Frustum frustum{-0.01, 0.01, -0.03, 0.03, 2, 6};
  const Rigid3 T_world_camera = mount_pose(0.0, 0.0, 1.0, 0.0, 90.0, 0.0);
  const auto packed = [&law](double depth_m) {
    return packed_depth(static_cast<std::int32_t>((1.0 / depth_m - law.offset_per_m) / law.slope_per_m + 0.5), 0x5A);
  };
  const std::vector<double> depths = {1.0, 1.0 - 1e-4, 1.0 + 1e-4, 1.0 - 3e-4, 1.0 + 3e-4, 0.5};
  std::vector<std::uint32_t> rows;
  for (const double depth : depths) rows.insert(rows.end(), {packed(depth), packed(depth)});
  rows[11] = packed_depth(0, 0x5A);  // nothing is seen
  std::vector<std::uint32_t> laid = rows;
  lay_paint_on_floor(frustum, T_world_camera, law, laid.data());
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(laid[i], i < 6 ? rows[0] : rows[i]) << i;

  const Rigid3 below = mount_pose(0.0, 0.0, -1.0, 0.0, 90.0, 0.0);
  laid = rows;
  lay_paint_on_floor(frustum, below, law, laid.data());
  EXPECT_EQ(laid, rows) << "from below no floor is seen";
}

}  // namespace
}  // namespace rigproof
