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

  bool has_relief() const { return !description.ground.flat(); }
};

/// Robot geoms are moved to this group, ceilings are in kCeilingGroup; both by convention of scenes and robots.
inline constexpr int kRobotGroup = 5;
inline constexpr int kCeilingGroup = 2;
/// Of a world whose ground is not flat: the floor that is seen, and the flat one that rays and contacts meet.
inline constexpr int kReliefGroup = 4, kFlatFloorGroup = 3;

/// The composed MJCF, with every texture declared at its size and left empty. Floors are flat.
/// @param more_geoms MJCF of further geoms of the world, which come last in it
/// @param more_assets MJCF of what these need
std::string compose_mjcf(const WorldDescription& description, const std::string& more_geoms = "",
                         const std::string& more_assets = "");
/// The folder that the composed text is compiled in: the robot's, so that its meshes are found.
std::filesystem::path base_folder(const WorldDescription& description);
/// @param position where the pose of the body stands among a state's coordinates
void set_pose(mjData* state, int position, const Rigid3& T_world_body);
/// What a geom belongs to: by its body, else by its name.
ObjectKind kind_of_geom(const mjModel* model, int geom, int robot_body);
/// Its own name, or its body's and its number.
std::string name_of_geom(const mjModel* model, int geom);

}  // namespace rigproof
