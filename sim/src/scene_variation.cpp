#include "rigproof/sim/scene_variation.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "scene_objects.h"

namespace rigproof {
namespace {

// Half the width of the robot and room beside it.
constexpr double kClearanceM = 0.7;
// Places drawn for one strewn object before it is left out.
constexpr int kPlaces = 60;

// Distance from a point to the straight path, as a line of its length.
double distance_to_path(const StraightPath& path, double x_m, double y_m) {
  const double heading = deg_to_rad(path.heading_deg), dx = x_m - path.x_m, dy = y_m - path.y_m;
  const double along = dx * std::cos(heading) + dy * std::sin(heading);
  const double nearest = std::clamp(along, 0.0, path.length_m);
  return std::hypot(dx - nearest * std::cos(heading), dy - nearest * std::sin(heading));
}

// True where an object would stand in the robot's way.
bool in_the_way(const SceneModel& scene, const SceneObject& object) {
  const FloorArea& area = scene.world.drivable_area;
  const double radius = object_radius_m(object);
  const double dx = std::max({area.x_min - object.x_m, 0.0, object.x_m - area.x_max});
  const double dy = std::max({area.y_min - object.y_m, 0.0, object.y_m - area.y_max});
  if (std::hypot(dx, dy) < radius + kClearanceM) return true;
  return scene.world.straight_path.length_m > 0.0 &&
         distance_to_path(scene.world.straight_path, object.x_m, object.y_m) < radius + kClearanceM;
}

// True where a round object meets the rectangle on which another stands.
bool touches(const SceneObject& object, const SceneObject& other) {
  const std::array<double, 3> size = object_size_m(other);
  const double heading = deg_to_rad(other.heading_deg), dx = object.x_m - other.x_m, dy = object.y_m - other.y_m;
  const double along = dx * std::cos(heading) + dy * std::sin(heading);
  const double across = dy * std::cos(heading) - dx * std::sin(heading);
  return std::hypot(std::max(0.0, std::abs(along) - 0.5 * size[0]), std::max(0.0, std::abs(across) - 0.5 * size[1])) <
         0.8 * object_radius_m(object);
}

bool touches_any(const SceneObject& object, const std::vector<SceneObject>& others) {
  return std::any_of(others.begin(), others.end(), [&](const SceneObject& other) { return touches(object, other); });
}

std::vector<SceneObject> strew(const SceneModel& scene, const SceneScatter& scatter, RandomStream random) {
  std::vector<SceneObject> strewn_ones;
  const long count = std::lround(scatter.count.sample(random));
  for (long i = 0; i < count; ++i) {
    SceneObject object = scatter.object;
    const double factor = scatter.size_factor.sample(random);
    const std::array<double, 3> size = object_size_m(object);
    for (std::size_t axis = 0; axis < size.size(); ++axis) object.size_m[axis] = factor * size[axis];
    for (int place = 0; place < kPlaces; ++place) {
      object.x_m = scatter.x_m.sample(random);
      object.y_m = scatter.y_m.sample(random);
      object.heading_deg = scatter.heading_deg.sample(random);
      if (in_the_way(scene, object) || touches_any(object, scene.world.objects) || touches_any(object, strewn_ones))
        continue;
      strewn_ones.push_back(object);
      break;
    }
  }
  return strewn_ones;
}

void vary_texture(const SceneVariation& variation, RandomStream random, SceneTexture* texture) {
  texture->scale = std::clamp(texture->scale * variation.texture_scale.sample(random), 0.05, 20.0);
  texture->contrast = std::clamp(texture->contrast * variation.texture_contrast.sample(random), 0.0, 4.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double factor = variation.texture_color.sample(random);
    texture->color[c] = std::clamp(factor * texture->color[c], 0.0, 1.0);
    texture->second_color[c] = std::clamp(factor * texture->second_color[c], 0.0, 1.0);
  }
}

void vary_light(const SceneVariation& variation, RandomStream random, SceneDescription* world) {
  world->light.brightness *= variation.light_brightness.sample(random);
  world->light.turn_deg += variation.light_turn_deg.sample(random);
  world->light.warmth = std::clamp(world->light.warmth + variation.light_warmth.sample(random), -1.0, 1.0);
  world->cloud_cover = std::clamp(world->cloud_cover + variation.cloud_cover.sample(random), 0.0, 1.0);
}

SceneObject moved(const SceneModel& scene, const SceneVariation& variation, RandomStream* random,
                  const SceneObject& object) {
  SceneObject elsewhere = object;
  elsewhere.x_m += variation.clutter_shift_m.sample(*random);
  elsewhere.y_m += variation.clutter_shift_m.sample(*random);
  elsewhere.heading_deg += variation.clutter_turn_deg.sample(*random);
  return in_the_way(scene, elsewhere) ? object : elsewhere;
}

}  // namespace

SceneModel strewn(const SceneModel& scene, std::uint64_t seed) {
  SceneModel result = scene;
  result.scatter.clear();
  for (std::size_t i = 0; i < scene.scatter.size(); ++i) {
    const std::vector<SceneObject> objects =
        strew(result, scene.scatter[i], RandomStream(seed, "scatter", static_cast<std::int64_t>(i)));
    result.world.objects.insert(result.world.objects.end(), objects.begin(), objects.end());
  }
  return result;
}

void SceneVariation::visit(FieldVisitor& visitor) {
  visitor.field("texture_scale", texture_scale, {0.1, 10.0}, "factor on the size of features, for each texture");
  visitor.field("texture_contrast", texture_contrast, {0.0, 4.0}, "factor on the strength of the pattern, for each");
  visitor.field("texture_color", texture_color, {0.0, 4.0}, "factor on red, green and blue, for each texture");
  visitor.field("light_brightness", light_brightness, {0.05, 4.0}, "factor on every light, once");
  visitor.field("light_turn_deg", light_turn_deg, {-360.0, 360.0}, "turn of all lights about the vertical, once");
  visitor.field("light_warmth", light_warmth, {-1.0, 1.0}, "-1 bluish to 1 reddish, once");
  visitor.field("cloud_cover", cloud_cover, {-1.0, 1.0}, "added to the scene's share of clouds in the sky, once");
  visitor.field("clutter_share", clutter_share, {0.0, 1.0}, "share of the scene's movable objects that are there");
  visitor.field("clutter_shift_m", clutter_shift_m, {-5.0, 5.0}, "along x and along y, for each movable object");
  visitor.field("clutter_turn_deg", clutter_turn_deg, {-360.0, 360.0}, "for each movable object");
}

SceneModel varied(const SceneModel& scene, const SceneVariation& variation, std::uint64_t seed) {
  SceneModel result = strewn(scene, seed);
  SceneDescription& world = result.world;
  for (std::size_t i = 0; i < world.textures.size(); ++i)
    vary_texture(variation, RandomStream(seed, "vary texture", static_cast<std::int64_t>(i)), &world.textures[i]);
  vary_light(variation, RandomStream(seed, "vary light"), &world);
  std::vector<SceneObject> objects;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    RandomStream random(seed, "vary object", static_cast<std::int64_t>(i));
    if (is_fixed(world.objects[i])) {
      objects.push_back(world.objects[i]);
      continue;
    }
    if (random.uniform() >= variation.clutter_share) continue;
    objects.push_back(moved(result, variation, &random, world.objects[i]));
  }
  world.objects = std::move(objects);
  return result;
}

}  // namespace rigproof
