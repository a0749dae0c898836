// A MuJoCo world composed of a scene, a robot with its cameras, and a board.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct WorldCamera {
  std::string name;
  Rigid3 T_robot_camera;
  Camera camera;
};

struct WorldDescription {
  std::filesystem::path robot_mjcf;  ///< body `robot` whose origin is the robot frame
  std::filesystem::path scene_mjcf;
  std::uint64_t scene_seed = 0;  ///< of the procedural textures
  std::vector<WorldCamera> cameras;
  Board board;
  Rigid3 T_world_board;
  double board_margin_m = 0.05;     ///< white border around the squares
  double board_thickness_m = 0.01;  ///< behind the printed face
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
  /// Free floor of the scene: the rectangle in which a robot may be placed [world frame, m].
  struct Area {
    double x_min, x_max, y_min, y_max;
  };
  Area drivable_area() const;

  const WorldDescription& description() const;
  ObjectKind kind_of_object(int object_id) const;
  static std::string mujoco_version();

  struct Impl;  ///< MuJoCo's structs stay behind this
  Impl& impl() { return *impl_; }
  const Impl& impl() const { return *impl_; }

 private:
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
