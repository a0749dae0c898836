#include "scene_objects.h"

#include <cmath>
#include <set>

#include "mjcf_text.h"
#include "object_shapes.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

const ObjectKinds& all_kinds() {
  static const ObjectKinds all = [] {
    ObjectKinds kinds = indoor_object_kinds();
    kinds.insert(outdoor_object_kinds().begin(), outdoor_object_kinds().end());
    return kinds;
  }();
  return all;
}

const ObjectPattern& pattern_of(const SceneObject& object) {
  const auto found = all_kinds().find(object.kind);
  if (found == all_kinds().end())
    throw Error("object of kind " + for_message(object.kind) + ": there is none; " +
                suggestion(object.kind, object_kinds()));
  return found->second;
}

std::string body_of(const SceneObject& object, std::size_t number, std::uint64_t seed) {
  ObjectShapes shapes(object, object_size_m(object),
                      RandomStream(seed, "object " + object.kind, static_cast<std::int64_t>(number)));
  pattern_of(object).build(&shapes);
  const Rigid3 T_world_object(rotation_z(deg_to_rad(object.heading_deg)), {object.x_m, object.y_m, object.z_m});
  return "  <body name=" + quoted("object_" + std::to_string(number) + "_" + object.kind) + " " +
         pose_attributes(T_world_object) + ">\n" + shapes.mjcf() + "  </body>\n";
}

}  // namespace

const std::vector<std::string>& object_kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, pattern] : all_kinds()) all.push_back(name);
    return all;
  }();
  return names;
}

std::array<double, 3> object_size_m(const SceneObject& object) {
  std::array<double, 3> size = pattern_of(object).size_m;
  for (std::size_t i = 0; i < size.size(); ++i)
    if (object.size_m[i] > 0.0) size[i] = object.size_m[i];
  return size;
}

double object_radius_m(const SceneObject& object) {
  const std::array<double, 3> size = object_size_m(object);
  return 0.5 * std::hypot(size[0], size[1]);
}

bool is_fixed(const SceneObject& object) { return pattern_of(object).is_fixed; }

ObjectsMjcf objects_mjcf(const SceneDescription& scene, std::uint64_t seed) {
  ObjectsMjcf mjcf;
  mjcf.assets = std::string("  <material name=\"") + kGlowMaterial + "\" specular=\"0\" emission=\"1\"/>\n";
  std::set<std::string> textures;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    mjcf.bodies += body_of(scene.objects[i], i, seed);
    textures.insert(scene.objects[i].texture);
    textures.insert(scene.objects[i].second_texture);
  }
  for (const std::string& texture : textures)
    if (!texture.empty())
      mjcf.assets += "  <material name=" + quoted(object_material(texture)) + " texture=" + quoted(texture) +
                     " specular=\"0\"/>\n";
  return mjcf;
}

}  // namespace rigproof
