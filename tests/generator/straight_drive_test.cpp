#include "rigproof/generator/straight_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/core/error.h"
#include "rigproof/generator/dataset.h"
#include "scenario.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

GenerateConfig small(const std::string& more) {
  return parse_generate_config("poses: 5\nimage_scale: 0.1\nscene: home\n" + more, "small");
}

TEST(StraightDrive, FollowsTheScenesPathAfterTheViewpoints) {
  const Scenario scenario = resolve_scenario(small("straight_drive: {frames: 4}\n"));
  ASSERT_EQ(scenario.stop_count(), 9U);
  ASSERT_EQ(scenario.recording.segments.size(), 1U);
  const RecordingSegment& segment = scenario.recording.segments[0];
  const StraightPath& path = scenario.world->description().scene.straight_path;
  for (std::size_t camera = 0; camera < scenario.camera_count(); ++camera)
    EXPECT_EQ(scenario.recording.frames_of(segment, camera).size(), 4U);
  EXPECT_FALSE(scenario.recording.in_segment(scenario.recording.frames[0][4]));
  const Rigid3 first = scenario.truth.stops[5].T_world_robot, last = scenario.truth.stops[8].T_world_robot;
  const Rigid3 driven = first.inverse() * last;
  EXPECT_LT((driven.translation - Eigen::Vector3d(path.length_m, 0.0, 0.0)).norm(), 1e-9) << "straight ahead";
  EXPECT_LT(std::abs(yaw_of(driven)), 1e-9);
  EXPECT_THAT(scenario.plan.coverage, HasSubstr("5 stops"));
  // The board is in none of these images: that is what they are for.
  for (std::size_t stop = 5; stop < 9; ++stop)
    for (const TrueCamera& camera : scenario.truth.cameras) {
      const Rigid3 T_world_camera = scenario.truth.stops[stop].T_world_robot * camera.T_robot_camera;
      Eigen::Vector2d pixel;
      const Eigen::Vector3d centre =
          T_world_camera.inverse() * (scenario.truth.T_world_board * scenario.truth.board.centre());
      EXPECT_FALSE(camera.camera.project(centre, &pixel) && camera.camera.contains(pixel)) << camera.name;
    }
}

TEST(StraightDrive, IsOffByDefault) {
  const Scenario scenario = resolve_scenario(small(""));
  EXPECT_EQ(scenario.stop_count(), 5U);
  EXPECT_TRUE(scenario.recording.segments.empty());
}

TEST(StraightDrive, TwoFramesAreNoLine) {
  EXPECT_THAT(error_text([] { small("straight_drive: {frames: 2}\n"); }), HasSubstr("straight_drive.frames"));
}

TEST(DataSet, MakesARunOfEachWorld) {
  const std::vector<GenerateConfig> runs = runs_of(small("name: ten\nseed: 7\nscenes: [home, meadow]\n"));
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].name, "ten/home");
  EXPECT_EQ(runs[1].scene, "meadow");
  EXPECT_EQ(runs[1].seed, 8);
  EXPECT_TRUE(runs[1].scenes.empty());
  EXPECT_EQ(runs_of(small("")).size(), 1U);
}

TEST(DataSet, NamesEveryWorldThatIsNotThere) {
  EXPECT_THAT(error_text([] { runs_of(small("scenes: [hame, home, medow, home]\n")); }),
              AllOf(HasSubstr("scenes[0]"), HasSubstr("hame"), HasSubstr("scenes[2]"), HasSubstr("twice")));
  EXPECT_THAT(error_text([] { resolve_scenario(small("scenes: [home, meadow]\n")); }),
              HasSubstr("--set scenes=[] --set scene=home"));
}

TEST(Randomize, ChangesTheWorldButNotTheRun) {
  const Scenario plain = resolve_scenario(small(""));
  const Scenario varied_one =
      resolve_scenario(small("randomize: {light_brightness: {uniform: [0.6, 0.8]}, clutter_share: 0.5}\n"));
  EXPECT_LT(varied_one.world->description().scene.light.brightness, 0.8);
  EXPECT_LT(varied_one.world->description().scene.objects.size(), plain.world->description().scene.objects.size());
  EXPECT_EQ(plain.world->description().T_world_board.translation,
            varied_one.world->description().T_world_board.translation);
  EXPECT_THAT(error_text([] { small("randomize: {light_brightness: {uniform: [-1, 1]}}\n"); }),
              HasSubstr("randomize.light_brightness"));
}

}  // namespace
}  // namespace rigproof
