// A catalogue of things that stand in scenes: furniture, machines, plants, cars. Boxes, cylinders and ellipsoids only,
// so that they cost next to nothing to draw and no model has to be shipped.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rigproof/sim/world.h"

namespace rigproof {

/// "desk", "tree", ...: what SceneObject::kind may be.
const std::vector<std::string>& object_kinds();

/// Depth, width and height of an object: its own, and its kind's where it gives none. Throws Error for an unknown kind.
std::array<double, 3> object_size_m(const SceneObject& object);

/// Radius of the circle on the floor around the object's place that holds all of it.
double object_radius_m(const SceneObject& object);

/// True for what is part of a building or rooted, such as doors and trees.
bool is_fixed(const SceneObject& object);

struct ObjectsMjcf {
  std::string assets;  ///< a material for each texture that objects use
  std::string bodies;  ///< one a object, named `object_NUMBER_KIND`
};
/// Details (how many boxes, which color) follow from the seed and the object's number.
ObjectsMjcf objects_mjcf(const SceneDescription& scene, std::uint64_t seed);

}  // namespace rigproof
