// The visible floor of a world whose ground is not flat: MuJoCo's planes and flat boxes give way to meshes.
#pragma once

#include <string>
#include <vector>

#include "mujoco_compat.h"
#include "rigproof/sim/relief.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// How the names of draped geoms begin.
inline constexpr const char* kReliefPrefix = "floor_relief_";

/// What the floor of a composed, flat world becomes.
struct FloorRelief {
  std::string assets;         ///< MJCF of the meshes
  std::string geoms;          ///< MJCF of the geoms; their names start with `floor`
  std::vector<int> replaced;  ///< geoms of the flat world, by number
};

/// Drapes the planes of the floor, and the paint, mats and lawns on them (boxes up to 1.5 cm high), over the relief.
/// Textures stay where they are. Higher floors (kerbs, islands) stay level.
/// @param kinds of the flat model's geoms
FloorRelief drape_floor(const mjModel& flat, const std::vector<ObjectKind>& kinds, const GroundRelief& relief);

}  // namespace rigproof
