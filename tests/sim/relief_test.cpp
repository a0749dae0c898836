// A floor that is not flat, in pictures: its heights are those that wheels stand on, its texture lies as it did.
#include "rigproof/sim/relief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "rigproof/core/conventions.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/physics.h"
#include "rigproof/sim/renderer.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

// A tiled floor with a line on it and a mat beside it, turned.
constexpr const char* kFloor = R"(<mujoco><asset>
<material name="tiles" texture="tiles" texrepeat="0.7 0.5" texuniform="true" specular="0"/>
<material name="mat" texture="tiles" texrepeat="3 1" specular="0"/></asset><worldbody>
<light directional="true" dir="0 0 -1" castshadow="true" diffuse="0.6 0.6 0.6" ambient="0.3 0.3 0.3" specular="0 0 0"/>
<geom name="floor" type="plane" pos="0.4 0 0" size="40 30 1" material="tiles"/>
<geom name="floor_line" type="box" pos="1.0 0 0" size="0.05 2 0.0005" rgba="1 1 0 1" contype="0" conaffinity="0"/>
<geom name="floor_mat" type="box" pos="-1 0.6 0" size="0.6 0.3 0.004" xyaxes="0.8 0.6 0 -0.6 0.8 0" material="mat"
      contype="0" conaffinity="0"/></worldbody></mujoco>)";

class ReliefPictures : public testing::Test {
 protected:
  ReliefPictures() {
    folder_.write("floor.xml", kFloor);
    folder_.write("floor.yaml",
                  "mjcf: floor.xml\ndrivable_area: {x_min_m: -3, x_max_m: 3, y_min_m: -3, y_max_m: 3}\n"
                  "board: {x_m: 20}\nshadows: true\n"
                  "textures: [{name: tiles, type: tiles, size_px: 256, color: [0.6, 0.5, 0.4]}]\n");
  }

  WorldDescription description(const GroundRelief& ground) const {
    const SceneModel scene = load_scene_model((folder_ / "floor.yaml").string());
    const RigModel rig = load_rig_model("husky_1x_d455");
    WorldDescription world =
        describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0);
    world.ground = ground;
    return world;
  }

  // From 3 m above, with the robot elsewhere.
  RenderedView look_down(const GroundRelief& ground) const {
    const auto world = World::compose(description(ground));
    world->place_robot(planar_pose(15.0, 15.0, 0.0));
    RenderOptions options;
    options.psf_sigma_px = 0.0;
    options.object_ids = true;
    Renderer renderer(*world, options);
    RenderedView view;
    renderer.render_from(T_world_camera_, camera_, true, &view);
    for (std::size_t i = 0; i < view.object_ids.pixels.size(); ++i)
      EXPECT_EQ(world->kind_of_object(view.object_ids.pixels[i]), ObjectKind::kFloor);
    return view;
  }

  static GroundRelief uneven(double sigma_m) {
    GroundRelief ground;
    ground.waves = uneven_floor(sigma_m, 1.5, 3);
    ground.extent = GroundRelief::Extent{0.0, 0.0, 4.0, 4.0, 1.0};
    return ground;
  }

  // Largest and root mean square difference of the seen heights to the relief's, paint and mat left out.
  void compare_heights(const GroundRelief& ground, double allowed_rms_m, double allowed_m) const {
    const RenderedView view = look_down(ground);
    double sum = 0.0, largest = 0.0;
    int count = 0;
    for (int y = 2; y < camera_.height_px - 2; y += 3)
      for (int x = 2; x < camera_.width_px - 2; x += 3) {
        Eigen::Vector3d ray;
        ASSERT_TRUE(camera_.unproject({x, y}, &ray));
        const Eigen::Vector3d p = T_world_camera_ * (ray / ray.z() * static_cast<double>(view.depth_m.at(x, y)));
        if (std::abs(p.x() - 1.0) < 0.1 || std::hypot(p.x() + 1.0, p.y() - 0.6) < 0.8) continue;
        const double error = p.z() - ground.height(p.head<2>());
        sum += error * error;
        largest = std::max(largest, std::abs(error));
        ++count;
      }
    ASSERT_GT(count, 10000);
    EXPECT_LT(std::sqrt(sum / count), allowed_rms_m);
    EXPECT_LT(largest, allowed_m);
  }

  TempFolder folder_;
  Camera camera_ = Camera::symmetric(640, 480, 320.0);
  Rigid3 T_world_camera_ = mount_pose(0.1, 0.05, 3.0, 0.0, 90.0, 0.0);
};

TEST_F(ReliefPictures, DepthSeesTheHeightsThatWheelsStandOn) {
  // Chords of a twelfth of the shortest wave.
  compare_heights(uneven(0.002), 0.0001, 0.0005);
  compare_heights(uneven(0.01), 0.0003, 0.0015);
  GroundRelief ramp;
  ramp.ramps = {{0.3, 0.2, 0.5, 0.1, 0.4, 0.8, 1.0}};
  ramp.extent = uneven(0.01).extent;
  compare_heights(ramp, 0.0003, 0.0015);
}

TEST_F(ReliefPictures, OfNoHeightLookLikeTheFlatFloor) {
  GroundRelief hair;
  hair.ramps = {{0.0, 0.0, 0.0, 1e-6, 0.5, 1.0, 2.0}};
  hair.extent = uneven(0.01).extent;
  const RenderedView flat = look_down({}), draped = look_down(hair);
  double sum = 0.0;
  std::size_t apart = 0;
  for (std::size_t i = 0; i < flat.color.pixels.size(); ++i) {
    const int difference = std::abs(flat.color.pixels[i] - draped.color.pixels[i]);
    sum += difference;
    apart += difference > 6 ? 1U : 0U;
  }
  const auto count = static_cast<double>(flat.color.pixels.size());
  EXPECT_LT(sum / count, 0.25) << "levels";
  EXPECT_LT(static_cast<double>(apart) / count, 0.002) << "edges of tiles, of the line, of the mat";
}

TEST_F(ReliefPictures, PaintStaysInSight) {
  const RenderedView view = look_down(uneven(0.01));
  int seen = 0;
  constexpr int kPlaces = 150;
  for (int i = 0; i < kPlaces; ++i) {
    const Eigen::Vector2d p(1.0, -1.5 + 3.0 * i / kPlaces);
    Eigen::Vector2d pixel;
    ASSERT_TRUE(
        camera_.project(T_world_camera_.inverse() * Eigen::Vector3d(p.x(), p.y(), uneven(0.01).height(p)), &pixel));
    const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
    const std::uint8_t* rgb =
        &view.color.pixels[3 * (static_cast<std::size_t>(y) * 640U + static_cast<std::size_t>(x))];
    seen += rgb[0] > 100 && rgb[2] < 30 ? 1 : 0;
  }
  EXPECT_GE(seen, kPlaces - 2);
}

TEST_F(ReliefPictures, WheelsStandOnWhatIsSeen) {
  const WorldDescription world = description(uneven(0.01));
  DrivePhysics physics(world, {});
  for (const double yaw : {0.0, 1.0, 2.0}) {
    physics.place(0.5 - yaw, 0.3 * yaw, yaw);
    while (physics.time_s() < 2.0) physics.step(0.0, 0.0);
    const Rigid3 T = physics.T_world_robot();
    std::vector<double> gaps;
    for (const double x : {-0.256, 0.256})
      for (const double y : {-0.285, 0.285}) {
        const Eigen::Vector3d foot = T * Eigen::Vector3d(x, y, 0.0);  // where this wheel touches flat ground
        gaps.push_back(foot.z() - world.ground.height(foot.head<2>()));
      }
    std::sort(gaps.begin(), gaps.end());
    // On flat ground tyres give way by 2.9 mm, and twice as much where two wheels carry all; their edges touch a slope
    // of 5 % 3 mm before their middles do. Without springs the fourth wheel may hang.
    EXPECT_GT(gaps[0], -0.0035) << yaw;
    EXPECT_LT(gaps[2], 0.006) << yaw;
  }
}

// Flat ground costs nothing and changes nothing, wherever it would fade out.
TEST_F(ReliefPictures, AFlatReliefIsNone) {
  GroundRelief flat;
  flat.extent = uneven(0.01).extent;
  EXPECT_EQ(World::compose(description(flat))->content_hash(), World::compose(description({}))->content_hash());
  EXPECT_NE(World::compose(description(uneven(0.01)))->content_hash(), World::compose(description({}))->content_hash());
  EXPECT_NE(World::compose(description(uneven(0.01)))->content_hash(),
            World::compose(description(uneven(0.011)))->content_hash());
}

}  // namespace
}  // namespace rigproof
