// Ways for a robot that turns on the spot and drives straight, around what stands in the way.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/sim/world.h"

namespace rigproof {

/// A place of the robot on the floor.
struct FloorPose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;

  Eigen::Vector2d ahead(double distance_m) const;
};

/// A turn on the spot to `end.yaw_rad`, or a straight way to `end.position`.
struct RouteLeg {
  enum class Kind { kTurn, kStraight };
  Kind kind = Kind::kTurn;
  FloorPose end;
  double turn_rad = 0.0;  ///< signed, of a turn
  bool backwards = false;
};
using Route = std::vector<RouteLeg>;

/// Plans among obstacles that it learns of by asking.
class RoutePlanner {
 public:
  /// Name of what a robot at this place would come too close to, or empty.
  using Obstacle = std::function<std::string(const FloorPose&)>;

  RoutePlanner(const FloorArea& area, Obstacle obstacle);

  /// The `number`-th best way that touches nothing, 0 the best one, or nothing where there are not so many.
  /// @param straight_in prefer ways that end with a straight piece along the goal's heading
  std::optional<Route> route(const FloorPose& start, const FloorPose& goal, int number, bool straight_in = false);
  /// What was in the way when route() last found none.
  std::string last_obstacle() const { return last_obstacle_; }

 private:
  class Candidates;
  bool is_free(const FloorPose& pose);
  bool can_turn(const FloorPose& pose, double turn_rad);
  bool can_drive(const FloorPose& from, double distance_m);
  bool can_turn_around(const Eigen::Vector2d& place);
  std::optional<Route> direct(const FloorPose& start, const FloorPose& goal, bool backwards);
  std::optional<Route> turn_and_drive(const FloorPose& start, const Eigen::Vector2d& to, bool backwards);
  bool append_turn(Route* route, FloorPose* pose, double yaw_rad);
  bool append_straight(Route* route, FloorPose* pose, const Eigen::Vector2d& to, bool backwards);
  std::optional<Route> between(const FloorPose& start, const FloorPose& goal, double out_m, double in_m,
                               bool backwards);
  std::optional<Route> around(const FloorPose& start, const FloorPose& goal, double out_m, double in_m);
  std::vector<Eigen::Vector2d> grid_path(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  FloorArea area_;
  Obstacle obstacle_;
  std::map<std::pair<int, int>, bool> turn_around_;  ///< by cell of the grid
  std::string last_obstacle_;
};

}  // namespace rigproof
