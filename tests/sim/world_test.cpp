#include "rigproof/sim/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/sim/models.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

WorldDescription lab() {
  const SceneModel scene = load_scene_model("indoor_lab");
  const RigModel rig = load_rig_model("husky_3x_d455");
  return describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0);
}

std::string error_of(const WorldDescription& description) {
  try {
    World::compose(description);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kBadInput);
    return error.what();
  }
  return "no error";
}

class WorldTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { world_ = World::compose(lab()).release(); }
  static void TearDownTestSuite() { delete world_; }
  static World& world() { return *world_; }

 private:
  static World* world_;
};
World* WorldTest::world_ = nullptr;

TEST_F(WorldTest, CamerasFollowTheRobot) {
  const Rigid3 T_world_robot = planar_pose(1.0, -2.0, 0.7);
  world().place_robot(T_world_robot);
  const Rigid3 expected = T_world_robot * world().description().cameras[1].T_robot_camera;
  EXPECT_LT(transform_error(world().T_world_camera(1), expected).norm(), 1e-12);
  EXPECT_LT(transform_error(world().T_world_robot(), T_world_robot).norm(), 1e-12);
}

TEST_F(WorldTest, FreeFloorHasNoCollision) {
  const FloorArea area = world().drivable_area();
  EXPECT_GE(area.x_max - area.x_min, 8.0);
  EXPECT_GE(area.y_max - area.y_min, 8.0);
  for (double x = area.x_min; x <= 3.4; x += 0.9)
    for (double y = area.y_min; y <= area.y_max; y += 0.9) {
      world().place_robot(planar_pose(x, y, x + y));
      EXPECT_THAT(world().collisions(), IsEmpty()) << x << " " << y;
    }
}

TEST_F(WorldTest, NamesWhatTheRobotTouches) {
  world().place_robot(planar_pose(-6.2, 0.0, 0.0));
  EXPECT_THAT(world().collisions(), Contains("wall_west"));
  const Eigen::Vector3d board = world().description().T_world_board.translation;
  world().place_robot(planar_pose(board.x(), board.y(), 0.0));
  EXPECT_THAT(world().collisions(), Contains("rigproof_stand"));
  world().place_robot(planar_pose(0.0, 0.0, 0.0));
  EXPECT_THAT(world().collisions(), IsEmpty());
}

TEST_F(WorldTest, RaysSeeTheSceneButNotTheRobot) {
  world().place_robot(planar_pose(0.0, 0.0, 0.0));
  ObjectKind kind = ObjectKind::kNothing;
  EXPECT_NEAR(world().cast_ray({0.0, 0.0, 2.0}, {0.0, 0.0, -5.0}, &kind), 2.0, 1e-9);
  EXPECT_EQ(kind, ObjectKind::kFloor);
  EXPECT_NEAR(world().cast_ray({0.0, 0.0, 1.9}, {-1.0, 0.0, 0.0}, &kind), 6.48 - 0.01, 0.05);
  EXPECT_EQ(kind, ObjectKind::kScene);
  const Rigid3& T_world_board = world().description().T_world_board;
  const Eigen::Vector3d centre = T_world_board * world().description().board.centre();
  const Eigen::Vector3d eye(1.0, 0.2, 0.9);
  EXPECT_NEAR(world().cast_ray(eye, centre - eye, &kind), (centre - eye).norm(), 1e-6);
  EXPECT_EQ(kind, ObjectKind::kBoard);
}

TEST_F(WorldTest, ObjectIdsOutsideOfTheModelAreNothing) {
  EXPECT_EQ(world().kind_of_object(0), ObjectKind::kNothing);
  EXPECT_EQ(world().kind_of_object(-3), ObjectKind::kNothing);
  EXPECT_EQ(world().kind_of_object(1 << 20), ObjectKind::kNothing);
}

TEST(WorldErrors, NamesTheFileThatMuJoCoRefuses) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "broken.xml";
  std::ofstream(file) << "<mujoco><worldbody><geom name=\"floor\" type=\"pyramid\"/></worldbody></mujoco>";
  WorldDescription description = lab();
  description.scene.mjcf = file;
  EXPECT_THAT(error_of(description), AllOf(HasSubstr(file.string()), HasSubstr("pyramid")));
  description = lab();
  description.robot_mjcf = file;
  EXPECT_THAT(error_of(description), HasSubstr(file.string()));
  std::ofstream(file) << "<mujoco><worldbody>";
  EXPECT_THAT(error_of(description), HasSubstr(file.string()));
}

TEST(WorldErrors, MissingFiles) {
  WorldDescription description = lab();
  description.scene.mjcf = "/nowhere/scene.xml";
  EXPECT_THAT(error_of(description), HasSubstr("/nowhere/scene.xml"));
  description = lab();
  description.robot_mjcf = "/nowhere/robot.xml";
  EXPECT_THAT(error_of(description), HasSubstr("/nowhere/robot.xml"));
}

TEST(WorldErrors, MissingAndUnknownTextures) {
  WorldDescription description = lab();
  description.scene.textures.erase(description.scene.textures.begin());
  EXPECT_THAT(error_of(description), AllOf(HasSubstr("indoor_lab.xml"), HasSubstr("lab_floor")));
  description = lab();
  description.scene.textures[0].type = "marble";
  EXPECT_THAT(error_of(description), AllOf(HasSubstr("marble"), HasSubstr("vinyl")));
  description = lab();
  description.scene.textures[0].type = "file";
  description.scene.textures[0].file = "/nowhere/floor.png";
  EXPECT_THAT(error_of(description), HasSubstr("/nowhere/floor.png"));
}

TEST(WorldErrors, RobotAndFloorMustBeThere) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "part.xml";
  std::ofstream(file)
      << "<mujoco><worldbody><body name=\"truck\"><freejoint/><geom size=\"1\"/></body></worldbody></mujoco>";
  WorldDescription description = lab();
  description.robot_mjcf = file;
  EXPECT_THAT(error_of(description), AllOf(HasSubstr(file.string()), HasSubstr("`robot`")));
  std::ofstream(file) << "<mujoco><worldbody><body name=\"robot\"><geom size=\"1\"/></body></worldbody></mujoco>";
  EXPECT_THAT(error_of(description), HasSubstr("freejoint"));
  std::ofstream(file)
      << "<mujoco><worldbody><geom name=\"ground\" type=\"plane\" size=\"1 1 1\"/></worldbody></mujoco>";
  description = lab();
  description.scene.mjcf = file;
  EXPECT_THAT(error_of(description), AllOf(HasSubstr(file.string()), HasSubstr("floor")));
}

TEST(WorldErrors, ImpossibleClipPlanes) {
  WorldDescription description = lab();
  description.scene.near_m = 30.0;
  EXPECT_THAT(error_of(description), HasSubstr("near_m"));
}

}  // namespace
}  // namespace rigproof
