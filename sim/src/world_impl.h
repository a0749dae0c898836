// The inside of World, shared with the renderer.
#pragma once

#include <string>
#include <vector>

#include "mujoco_compat.h"
#include "rigproof/sim/world.h"

namespace rigproof {

struct World::Impl {
  WorldDescription description;
  mujoco::ModelPtr model;
  mujoco::DataPtr data;
  Rigid3 T_world_robot;
  int robot_body = -1;
  int robot_position = -1;             ///< of the free joint, in qpos
  std::vector<ObjectKind> geom_kinds;  ///< by geom
  bool collisions_are_current = false;
};

/// Robot geoms are moved to this group, ceilings are in kCeilingGroup; both by convention of scenes and robots.
inline constexpr int kRobotGroup = 5;
inline constexpr int kCeilingGroup = 2;

/// The composed MJCF, with every texture declared at its size and left empty.
/// @param more_geoms MJCF of further geoms of the world
std::string compose_mjcf(const WorldDescription& description, const std::string& more_geoms = "");
/// The folder that the composed text is compiled in: the robot's, so that its meshes are found.
std::filesystem::path base_folder(const WorldDescription& description);
/// What a geom belongs to: by its body, else by its name.
ObjectKind kind_of_geom(const mjModel* model, int geom, int robot_body);
/// Its own name, or its body's and its number.
std::string name_of_geom(const mjModel* model, int geom);

}  // namespace rigproof
