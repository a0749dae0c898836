// Where the robot stands when it takes images.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/generator/config.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// What the planner asks of the world. Poses and points are in the scene's frame.
class ViewpointWorld {
 public:
  virtual ~ViewpointWorld() = default;
  virtual FloorArea drivable_area() = 0;
  /// Name of something that the robot would touch, or empty.
  virtual std::string obstacle(const Rigid3& T_scene_robot) = 0;
  /// True if nothing but the board is met on the way from `origin` to `target`, a point of the subject's board of that
  /// number.
  virtual bool in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, std::size_t board) = 0;
};

/// The same for a composed world; moves its robot.
class ComposedViewpointWorld : public ViewpointWorld {
 public:
  explicit ComposedViewpointWorld(World& world) : world_(world) {}
  FloorArea drivable_area() override { return world_.drivable_area(); }
  std::string obstacle(const Rigid3& T_scene_robot) override;
  bool in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, std::size_t board) override;

 private:
  World& world_;
};

/// A board to be seen.
struct ViewedBoard {
  Board board;
  Rigid3 T_scene_board;
  double board_margin_m = 0.05;  ///< white border, to be in the image as well
};

/// What is to be seen, and from which cameras. Its own members of a board are those of the first one.
struct ViewpointSubject : ViewedBoard {
  std::vector<WorldCamera> cameras;
  std::vector<ViewedBoard> more_boards = {};

  std::size_t boards() const { return 1 + more_boards.size(); }
  const ViewedBoard& board_at(std::size_t index) const {
    return index == 0 ? static_cast<const ViewedBoard&>(*this) : more_boards[index - 1];
  }
};

/// One stop of the robot.
struct Viewpoint {
  double x_m = 0.0;  ///< scene's frame
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double distance_m = 0.0;     ///< from the centre of the nearest board, along the floor
  double bearing_rad = 0.0;    ///< as seen from that board, 0 = straight in front of it
  double obliquity_rad = 0.0;  ///< largest of the cameras that see a board
  int cameras_with_board = 0;  ///< cameras with a whole board, its border, and the margin, unhidden

  Rigid3 T_scene_robot() const { return planar_pose(x_m, y_m, yaw_rad); }
};

struct ViewpointPlan {
  std::vector<Viewpoint> stops;  ///< in the order of driving
  std::size_t straight = 0;      ///< of them the last, which are frames of a straight drive
  std::size_t skipped = 0;       ///< planner grid: places that break a constraint
  std::string coverage;          ///< in words
};

/// Plans the stops. Deterministic in (config, subject, world, poses, seed): stop i is drawn from its own stream, and,
/// of planner `covering`, depends on those before it. Throws Error that says which constraint turned down most
/// candidates, or which listed place is impossible.
ViewpointPlan plan_viewpoints(const ViewpointConfig& config, std::int64_t poses, const ViewpointSubject& subject,
                              ViewpointWorld& world, std::uint64_t seed);

/// A place that keeps every constraint, as the planner `covering` or `sampled` draws the one of this number; nothing if
/// none was found.
/// @param before the stops that are there already: what they show, `covering` shows last
std::optional<Viewpoint> draw_viewpoint(const ViewpointConfig& config, std::int64_t number,
                                        const ViewpointSubject& subject, ViewpointWorld& world,
                                        const std::vector<Viewpoint>& before, std::uint64_t seed);

/// "100 stops 1.2 to 3.6 m from the board, bearing -54 to 53 deg, ...".
std::string describe_coverage(const std::vector<Viewpoint>& stops, std::size_t cameras);

}  // namespace rigproof
