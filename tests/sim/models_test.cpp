#include "rigproof/sim/models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "error_text.h"
#include "pose_near.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Models, EverythingThatShipsLoads) {
  EXPECT_THAT(scene_model_names(), ElementsAre("asphalt_lot", "corridor", "gravel", "home", "indoor_lab", "meadow",
                                               "office", "outdoor_yard", "warehouse", "workshop"));
  for (const std::string& name : scene_model_names()) EXPECT_FALSE(load_scene_model(name).description.empty()) << name;
  EXPECT_THAT(rig_model_names(), Contains("husky_3x_d455"));
  for (const std::string& name : list_presets("robots")) EXPECT_GT(load_robot_model(name).mass_kg, 0.0) << name;
  for (const std::string& name : rig_model_names()) {
    const RigModel rig = load_rig_model(name);
    EXPECT_EQ(rig.rig.cameras.size(), rig.T_robot_camera.size()) << name;
    EXPECT_FALSE(rig.description.empty()) << name;
  }
}

std::unique_ptr<World> world_of(const std::string& rig_name, const std::string& scene_name) {
  const SceneModel scene = load_scene_model(scene_name);
  const RigModel rig = load_rig_model(rig_name);
  const Rigid3 T_world_board = place_board(rig.rig.board, scene.board.middle());
  return World::compose(describe_world(rig, scene, rig.rig.board, T_world_board, 1));
}

TEST(Models, EveryRigComposes) {
  for (const std::string& rig : rig_model_names()) EXPECT_TRUE(world_of(rig, "home")->collisions().empty()) << rig;
}

// The robot can be anywhere in the drivable area that is not near the board, and on the whole straight path.
TEST(Models, EverySceneComposesAndIsFreeWhereItSaysSo) {
  for (const std::string& name : scene_model_names()) {
    const SceneModel scene = load_scene_model(name);
    const auto world = world_of("husky_3x_d455", name);
    const FloorArea& area = scene.world.drivable_area;
    for (double x = area.x_min; x <= scene.board.x_m.lowest() - 0.9; x += 0.7) {
      for (double y = area.y_min; y <= area.y_max; y += 0.5) {
        world->place_robot(planar_pose(x, y, 3.0 * x + y));
        EXPECT_THAT(world->collisions(), IsEmpty()) << name << " " << x << " " << y;
      }
    }
    const StraightPath& path = scene.world.straight_path;
    ASSERT_GT(path.length_m, 3.0) << name;
    const double heading = deg_to_rad(path.heading_deg);
    for (double along = 0.0; along <= path.length_m; along += 0.5) {
      world->place_robot(
          planar_pose(path.x_m + along * std::cos(heading), path.y_m + along * std::sin(heading), heading));
      EXPECT_THAT(world->collisions(), IsEmpty()) << name << " " << along << " m along the straight path";
    }
  }
}

TEST(Models, MountLooksWhereItsAnglesSay) {
  const Rigid3 ahead = mount_pose(0.1, 0.2, 0.3, 0.0, 0.0, 0.0);
  EXPECT_LT((ahead * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_LT((ahead.rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((ahead.rotation * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  // Positive pitch looks down, positive yaw to the left.
  EXPECT_LT((mount_pose(0, 0, 0, 0, 90, 0).rotation * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  EXPECT_LT((mount_pose(0, 0, 0, 0, 0, 90).rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(),
            1e-12);
}

TEST(Models, BoardStandsUprightAndFacesItsViewer) {
  const Board board;
  BoardPlacement placement;
  placement.x_m = 3.0;
  placement.z_m = 0.7;
  placement.facing_deg = 180.0;
  const Rigid3 T = place_board(board, placement);
  EXPECT_LT((T * board.centre() - Eigen::Vector3d(3.0, 0.0, 0.7)).norm(), 1e-12);
  EXPECT_LT((T.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);  // into the board
  EXPECT_LT((T.rotation * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);  // down
  placement.lean_deg = 90.0;                                                                    // lies on its back
  EXPECT_LT((place_board(board, placement).rotation * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  placement.lean_deg = 0.0;
  placement.roll_deg = 90.0;  // anticlockwise for the viewer, whose right is -y: board x points up
  EXPECT_LT((place_board(board, placement).rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
}

TEST(Models, UnknownNamesNameWhatThereIs) {
  EXPECT_THAT(error_text([] { load_scene_model("indor_lab"); }),
              AllOf(HasSubstr("indor_lab"), HasSubstr("indoor_lab")));
  EXPECT_THAT(error_text([] { load_rig_model("husky"); }), HasSubstr("husky_3x_d455"));
}

TEST(Models, ARigWithMistakesNamesThemAll) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "mine.yaml";
  std::ofstream(file) << "robot: husky\ncameras:\n  left:\n    sensor: d455\n    mount: {x_m: far, y_m: 0, z_m: 0.5}\n"
                         "  right:\n    sensor: d455\n    mont: {x_m: 0, y_m: 0, z_m: 1}\n";
  const std::string error = error_text([&] { load_rig_model(file.string()); });
  EXPECT_THAT(error, AllOf(HasSubstr("mine.yaml:5"), HasSubstr("x_m"), HasSubstr("far")));
  EXPECT_THAT(error, AllOf(HasSubstr("mont"), HasSubstr("cameras.right")));
}

TEST(Models, NineCamerasAreTooMany) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "many.yaml";
  std::ofstream out(file);
  out << "robot: husky\ncameras:\n";
  for (int i = 0; i < 9; ++i) out << "  c" << i << ": {sensor: d455, mount: {x_m: 0, y_m: 0, z_m: 1}}\n";
  out.close();
  EXPECT_THAT(error_text([&] { load_rig_model(file.string()); }), HasSubstr("1 to 8 cameras"));
}

TEST(Models, ASceneWithMistakesNamesThemAll) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "mine.yaml";
  std::ofstream(file) << "mjcf: mine.xml\nnear_m: -1\ndrivable_area: {x_min_m: 2, x_max_m: 1, y_min_m: 0, y_max_m: 1}\n"
                         "textures:\n  - {name: a, type: marble}\n  - {name: b, type: plain, size_px: 100}\n";
  const std::string error = error_text([&] { load_scene_model(file.string()); });
  EXPECT_THAT(error, AllOf(HasSubstr("near_m"), HasSubstr("marble"), HasSubstr("power of two"), HasSubstr("x_min_m")));
}

}  // namespace
}  // namespace rigproof
