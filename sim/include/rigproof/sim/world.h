// A MuJoCo world composed of a scene, a robot with its cameras, and a board.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/lens_residual.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/sim/board_defects.h"
#include "rigproof/sim/relief.h"

namespace rigproof {

struct WorldCamera {
  std::string name;
  Rigid3 T_robot_camera;
  Camera camera;
  /// Where depth is measured; without it, at the camera's own place and with its pixels.
  std::optional<DepthStream::OwnCamera> depth_camera = std::nullopt;
  /// What the camera's lens does beyond its model, in colour and in depth with its pixels.
  std::optional<LensResidual> lens_residual = std::nullopt;
};

/// A texture that a scene's MJCF refers to by name: procedural and seeded, or an image file.
struct SceneTexture {
  std::string name;            ///< as the MJCF's materials call it
  std::string type;            ///< see texture_types() in textures.h, or "file"
  std::filesystem::path file;  ///< for type "file"
  int size_px = 1024;          ///< side of the square texture, a power of two
  bool cube = false;           ///< wrapped around boxes and cylinders, every side the same, instead of laid flat
  double scale = 1.0;          ///< size of the features relative to the type's default
  double contrast = 1.0;       ///< strength of the pattern relative to the type's default
  std::array<double, 3> color = {0.5, 0.5, 0.5};         ///< main colour, 0 to 1
  std::array<double, 3> second_color = {0.3, 0.3, 0.3};  ///< joints, mortar, stains, ...
};

/// Free floor of a scene: the rectangle in which a robot may be placed [world frame, m].
struct FloorArea {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
};

/// Where a robot can drive straight ahead without the board in view, for methods that need such images.
struct StraightPath {
  double x_m = 0.0;  ///< start of the robot, world frame
  double y_m = 0.0;
  double heading_deg = 0.0;
  double length_m = 0.0;  ///< 0 = the scene has none
};

/// Furniture, a tree, a car: a thing made of simple shapes that stands in a scene, as a block of its `objects`.
struct SceneObject {
  std::string kind;                                ///< see object_kinds()
  double x_m = 0.0, y_m = 0.0, z_m = 0.0;          ///< the middle of its foot, world frame
  double heading_deg = 0.0;                        ///< where its front looks
  std::array<double, 3> size_m = {0.0, 0.0, 0.0};  ///< depth (along its front), width, height; 0 = the kind's own
  std::string texture;                             ///< of its main part: a texture of the scene; empty = plain
  std::string second_texture;                      ///< of another part: cushions, leaves, boxes, a roof
  std::optional<std::array<double, 3>> color;      ///< of its main part; with a texture: its tint
};

/// A change of all of a scene's lights together: another hour, another weather.
struct LightChange {
  double brightness = 1.0;  ///< factor on every light
  double turn_deg = 0.0;    ///< turn of all lights about the vertical
  double warmth = 0.0;      ///< -1 bluish to 1 reddish; 0 = as the scene has it
};

/// The scene as World::compose needs it. Geoms whose name starts with `floor` are floor; geoms of group 2 are
/// ceiling, which pictures from above leave out.
struct SceneDescription {
  std::filesystem::path mjcf;
  std::vector<SceneTexture> textures;
  FloorArea drivable_area;
  double near_m = 0.35;  ///< nothing nearer than this to a camera is seen; depth resolution depends on it
  double far_m = 20.0;
  std::array<double, 3> sky_zenith = {0.5, 0.6, 0.8};
  std::array<double, 3> sky_horizon = {0.8, 0.85, 0.9};
  double cloud_cover = 0.0;  ///< share of the sky, roughly
  std::array<double, 3> cloud_color = {0.95, 0.95, 0.95};
  bool shadows = false;  ///< cast by the scene's lights; rendering takes longer
  std::vector<SceneObject> objects;
  LightChange light;
  StraightPath straight_path;
};

/// A board and where it stands.
struct WorldBoard {
  Board board;
  Rigid3 T_world_board;
  double board_margin_m = 0.05;     ///< white border around the squares
  double board_thickness_m = 0.01;  ///< behind the printed face
  BoardDefects board_defects;
};

/// Its own members of a board are those of the first one.
struct WorldDescription : WorldBoard {
  std::filesystem::path robot_mjcf;  ///< body `robot` whose origin is the robot frame
  SceneDescription scene;
  std::uint64_t scene_seed = 0;  ///< of the procedural textures
  std::vector<WorldCamera> cameras;
  std::vector<WorldBoard> more_boards;
  GroundRelief ground;  ///< of the floor, where it is not flat: of its pictures and of what wheels stand on

  std::size_t boards() const { return 1 + more_boards.size(); }
  const WorldBoard& board_at(std::size_t index) const {
    return index == 0 ? static_cast<const WorldBoard&>(*this) : more_boards[index - 1];
  }
};

/// What a pixel of the object-id image shows.
enum class ObjectKind { kNothing, kFloor, kBoard, kRobot, kScene };

/// The composed model and its state. One thread at a time.
class World {
 public:
  /// Throws Error that names the file and MuJoCo's complaint.
  static std::unique_ptr<World> compose(const WorldDescription& description);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Places the robot kinematically, wheels included.
  void place_robot(const Rigid3& T_world_robot);
  const Rigid3& T_world_robot() const;
  Rigid3 T_world_camera(std::size_t camera) const;
  /// Names of what the robot touches at its present place, other than the floor; empty = free.
  std::vector<std::string> collisions() const;
  /// Distance along the ray to the first thing hit that is not the robot, and what it is; infinity if nothing.
  double cast_ray(const Eigen::Vector3d& origin_world, const Eigen::Vector3d& direction_world,
                  ObjectKind* hit = nullptr) const;
  /// Which board's printed face or back the ray meets before anything else.
  std::optional<std::size_t> cast_ray_to_board(const Eigen::Vector3d& origin_world,
                                               const Eigen::Vector3d& direction_world) const;
  FloorArea drivable_area() const;

  const WorldDescription& description() const;
  ObjectKind kind_of_object(int object_id) const;
  static std::string mujoco_version();

  /// SHA-256 of all that pictures of this world depend on, but for its state and the camera. The compiled model is part
  /// of it, textures included.
  std::string content_hash() const;
  /// SHA-256 of the present state as a camera sees it: the camera's intrinsics and pose, and where everything is.
  std::string view_hash(std::size_t camera) const;

  struct Impl;  ///< MuJoCo's structs stay behind this
  Impl& impl() { return *impl_; }
  const Impl& impl() const { return *impl_; }

 private:
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
