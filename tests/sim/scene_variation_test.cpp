#include "rigproof/sim/scene_variation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "error_text.h"
#include "rigproof/core/error.h"
#include "scene_objects.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Distribution uniform(double low, double high) { return Distribution::Kind(Distribution::Uniform{low, high}); }

std::vector<std::array<double, 3>> places_of(const SceneModel& scene) {
  std::vector<std::array<double, 3>> places;
  for (const SceneObject& object : scene.world.objects) places.push_back({object.x_m, object.y_m, object.heading_deg});
  return places;
}

TEST(Scatter, IsTheSameForASeedAndAnotherForTheNext) {
  const SceneModel meadow = load_scene_model("meadow");
  const SceneModel one = strewn(meadow, 1), again = strewn(meadow, 1), other = strewn(meadow, 2);
  EXPECT_GT(one.world.objects.size(), meadow.world.objects.size() + 20);
  EXPECT_EQ(places_of(one), places_of(again));
  EXPECT_NE(places_of(one), places_of(other));
  EXPECT_EQ(places_of(strewn(one, 5)), places_of(one)) << "nothing is strewn twice";
}

TEST(Scatter, KeepsTheRobotsWayFree) {
  for (const std::string& name : scene_model_names()) {
    const SceneModel scene = load_scene_model(name);
    const std::size_t fixed = scene.world.objects.size();
    const SceneModel full = strewn(scene, 3);
    const FloorArea& area = scene.world.drivable_area;
    for (std::size_t i = fixed; i < full.world.objects.size(); ++i) {
      const SceneObject& object = full.world.objects[i];
      const double dx = std::max({area.x_min - object.x_m, 0.0, object.x_m - area.x_max});
      const double dy = std::max({area.y_min - object.y_m, 0.0, object.y_m - area.y_max});
      // Half a Husky's width, at least.
      EXPECT_GT(std::hypot(dx, dy), object_radius_m(object) + 0.35) << name << " " << object.kind;
    }
  }
}

TEST(Variation, ByDefaultChangesNothing) {
  const SceneModel office = load_scene_model("office");
  const SceneModel plain = strewn(office, 7), same = varied(office, SceneVariation(), 7);
  EXPECT_EQ(places_of(plain), places_of(same));
  for (std::size_t i = 0; i < plain.world.textures.size(); ++i) {
    EXPECT_EQ(plain.world.textures[i].color, same.world.textures[i].color);
    EXPECT_EQ(plain.world.textures[i].scale, same.world.textures[i].scale);
  }
  EXPECT_EQ(same.world.light.brightness, 1.0);
  EXPECT_EQ(same.world.light.turn_deg, 0.0);
}

TEST(Variation, DrawsWithinItsDistributionsAndByTheSeed) {
  SceneVariation variation;
  variation.texture_color = uniform(0.8, 1.2);
  variation.light_brightness = uniform(0.7, 0.9);
  variation.light_turn_deg = uniform(10.0, 20.0);
  variation.clutter_shift_m = uniform(-0.2, 0.2);
  variation.clutter_share = 0.5;
  const SceneModel office = load_scene_model("office");
  const SceneModel one = varied(office, variation, 1), again = varied(office, variation, 1),
                   other = varied(office, variation, 2);
  EXPECT_EQ(places_of(one), places_of(again));
  EXPECT_EQ(one.world.light.turn_deg, again.world.light.turn_deg);
  EXPECT_NE(one.world.light.turn_deg, other.world.light.turn_deg);
  EXPECT_GE(one.world.light.brightness, 0.7);
  EXPECT_LE(one.world.light.brightness, 0.9);
  const auto fixed_count = [](const SceneModel& scene) {
    return std::count_if(scene.world.objects.begin(), scene.world.objects.end(), is_fixed);
  };
  EXPECT_EQ(fixed_count(one), fixed_count(office)) << "what belongs to the building stays";
  const double share =
      static_cast<double>(one.world.objects.size()) / static_cast<double>(strewn(office, 1).world.objects.size());
  EXPECT_NEAR(share, 0.5, 0.3);  // four standard deviations of 40 objects
  for (std::size_t i = 0; i < one.world.textures.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double before = office.world.textures[i].color[c], after = one.world.textures[i].color[c];
      EXPECT_GE(after, 0.8 * before - 1e-12);
      EXPECT_LE(after, std::min(1.0, 1.2 * before + 1e-12));
    }
}

TEST(Variation, OfWhateverSizeLeavesTheWayFree) {
  SceneVariation variation;
  variation.clutter_shift_m = uniform(-3.0, 3.0);
  variation.clutter_turn_deg = uniform(-180.0, 180.0);
  for (const char* name : {"home", "corridor"}) {
    const SceneModel scene = varied(load_scene_model(name), variation, 4);
    const RigModel rig = load_rig_model("husky_3x_d455");
    const auto world =
        World::compose(describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 4));
    const FloorArea& area = scene.world.drivable_area;
    for (double x = area.x_min; x < scene.board.x_m.lowest() - 0.9; x += 0.6)
      for (double y = area.y_min; y <= area.y_max; y += 0.6) {
        world->place_robot(planar_pose(x, y, x - y));
        EXPECT_TRUE(world->collisions().empty()) << name << " " << x << " " << y;
      }
  }
}

TEST(Objects, EveryKindIsAcceptedByMuJoCoAndStandsOnTheFloor) {
  const TempFolder folder;
  std::string text = "mjcf: hall.xml\ndrivable_area: {x_min_m: -2, x_max_m: 2, y_min_m: -2, y_max_m: 2}\nobjects:\n";
  int number = 0;
  for (const std::string& kind : object_kinds())
    text += "  - {kind: " + kind + ", place_m: [" + std::to_string(20 + 15 * (number++)) + ", 0]}\n";
  folder.write("hall.yaml", text);
  folder.write("hall.xml",
               "<mujoco><worldbody><geom name=\"floor\" type=\"plane\" size=\"9 9 1\"/></worldbody></mujoco>");
  const SceneModel scene = load_scene_model((folder / "hall.yaml").string());
  const RigModel rig = load_rig_model("husky_1x_d455");
  const auto world =
      World::compose(describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0));
  // A ray down onto the middle meets the object, none higher than it says (lamps and scaffolds have a bit on top).
  for (const SceneObject& object : scene.world.objects) {
    const double tall = object_size_m(object)[2];
    EXPECT_GT(tall, 0.0) << object.kind;
    EXPECT_GT(object_radius_m(object), 0.0) << object.kind;
    EXPECT_GT(world->cast_ray({object.x_m, object.y_m, 30.0}, {0.0, 0.0, -1.0}), 30.0 - tall - 1.3) << object.kind;
  }
}

TEST(Objects, MistakesAreNamedWithTheirPlace) {
  const TempFolder folder;
  folder.write(
      "hall.yaml",
      "mjcf: hall.xml\ntextures:\n  - {name: oak, type: wood}\nobjects:\n  - {kind: dask, place_m: [1, 2]}\n"
      "  - {kind: desk, place_m: [1, 2], texture: oka}\n  - {kind: desk, place_m: [1]}\n"
      "  - {kind: desk, place_m: [1, 2], size_m: [1, 0, 1]}\nscatter:\n  - {kind: rock, count: {uniform: [-3, 2]}}\n");
  const std::string error = error_text([&] { load_scene_model((folder / "hall.yaml").string()); });
  EXPECT_THAT(error, AllOf(HasSubstr("hall.yaml:5"), HasSubstr("dask"), HasSubstr("desk")));
  EXPECT_THAT(error, AllOf(HasSubstr("hall.yaml:6"), HasSubstr("did you mean \"oak\"")));
  EXPECT_THAT(error, AllOf(HasSubstr("place_m"), HasSubstr("size_m"), HasSubstr("count")));
}

}  // namespace
}  // namespace rigproof
