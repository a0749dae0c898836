// Robots, rigs and scenes as their YAML files describe them, and how a world is put together from them.
//
// Names are looked up in models/robots, models/rigs and scenes; a path to a YAML file works wherever a name does.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/distribution.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// models/robots/NAME.yaml: a wheeled robot. Its MJCF holds the body `robot`, whose origin is the robot frame.
struct RobotModel {
  std::filesystem::path file;
  std::string name;
  std::string description;
  std::filesystem::path mjcf;
  double mass_kg = 0.0;
  double wheel_radius_m = 0.0;
  double track_m = 0.0;                 ///< between the middles of left and right wheels
  double wheelbase_m = 0.0;             ///< between front and rear axles
  double slip_factor = 1.0;             ///< nominal effective track over track (skid steering; 1 = no slip)
  double encoder_ticks_per_turn = 0.0;  ///< of a wheel; 0 = continuous
  double footprint_length_m = 0.0;
  double footprint_width_m = 0.0;
};

/// models/rigs/NAME.yaml: 1 to 8 cameras on a robot.
struct RigModel {
  std::string name;
  std::string description;
  RobotModel robot;
  Rig rig;                             ///< what a recording of this rig tells its user: sensors, intrinsics, board
  std::vector<Rigid3> T_robot_camera;  ///< true mounting, one a camera of `rig`
};

/// Where a board stands: the middle of its squares, and which way its printed face looks.
struct BoardPlacement {
  double x_m = 0.0;  ///< world frame
  double y_m = 0.0;
  double z_m = 0.0;         ///< height of the middle
  double facing_deg = 0.0;  ///< heading of the outward normal: 0 = looks along world x, 90 = along world y
  double lean_deg = 0.0;    ///< the normal points up by this angle (the board leans back)
  double roll_deg = 0.0;    ///< turn of the board about its outward normal, anticlockwise as a viewer sees it
};
/// T_world_board of a placement: with no roll, board x points to a viewer's right and board y down.
Rigid3 place_board(const Board& board, const BoardPlacement& placement);

/// The range of places that a scene offers to a board.
struct BoardPlacementRange {
  Distribution x_m, y_m, z_m, facing_deg, lean_deg, roll_deg;
  BoardPlacement sample(RandomStream& random) const;
  /// Every value at its mean.
  BoardPlacement middle() const;
};

/// Objects of one kind strewn at random: which places, how many and how large follows from a seed.
struct SceneScatter {
  SceneObject object;        ///< kind, textures, size and tint; its place and heading are drawn
  Distribution count = 5.0;  ///< rounded
  Distribution x_m, y_m;
  Distribution heading_deg = Distribution::Kind(Distribution::Uniform{-180.0, 180.0});
  Distribution size_factor = 1.0;  ///< drawn for each object
};

/// scenes/NAME.yaml with its MJCF.
struct SceneModel {
  std::string name;
  std::string description;
  bool outdoor = false;
  SceneDescription world;     ///< what World::compose needs
  BoardPlacementRange board;  ///< where the board stands by default
  std::vector<SceneScatter> scatter;
};

/// Load by name or by path. Throw Error with every problem of the file, or with the names that exist.
RobotModel load_robot_model(const std::string& name_or_file);
RigModel load_rig_model(const std::string& name_or_file);
SceneModel load_scene_model(const std::string& name_or_file);

/// All fields of a scene as text, but for its description and the folders of its files: the same text, the same scene,
/// given the same MJCF and pictures.
std::string scene_text(const SceneModel& scene);

/// Names of the models that are installed, sorted.
std::vector<std::string> rig_model_names();
std::vector<std::string> scene_model_names();

/// T_robot_camera of a mount: the camera's place in the robot frame, and the attitude of its body axes (x forward along
/// the optical axis, y left, z up) as R = Rz(yaw) Ry(pitch) Rx(roll): positive pitch looks down, positive yaw left.
Rigid3 mount_pose(double x_m, double y_m, double z_m, double roll_deg, double pitch_deg, double yaw_deg);

/// The scene with what is strewn in it drawn for a seed: its `scatter` becomes objects. None of them stands in the
/// drivable area, on the straight path, or touches another strewn one; what finds no place is left out.
SceneModel strewn(const SceneModel& scene, std::uint64_t seed);

/// The whole world: robot and cameras of the rig, the scene, a board and where it stands.
WorldDescription describe_world(const RigModel& rig, const SceneModel& scene, const Board& board,
                                const Rigid3& T_world_board, std::uint64_t seed);

}  // namespace rigproof
