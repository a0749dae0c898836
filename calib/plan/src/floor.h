// Where the robot may stand and drive, and how it gets there.
#pragma once

#include <vector>

#include "rigproof/calib/plan/suggest.h"
#include "rigproof/core/board.h"

namespace rigproof::suggest {

/// A place on the floor of the world.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Rigid3 T_world_robot() const { return planar_pose(x_m, y_m, yaw_rad); }
  static Place of(const Rigid3& T_world_robot);
  /// Turned on the spot to a heading, about a point of the robot.
  Place turned_to(double heading_rad, const Eigen::Vector2d& about_m) const;
};

/// The corners of a board's outline, seen from above.
using Footprint = std::vector<Eigen::Vector2d>;
Footprint footprint_of(const Board& board, const Rigid3& T_world_board);

/// The free floor around boards.
class Floor {
 public:
  Floor(const SuggestOptions& options, const std::vector<Rigid3>& T_world_robot, std::vector<Footprint> boards);

  const DriveArea& area() const { return area_; }  ///< in the first stop's frame
  const Rigid3& T_world_first() const { return T_world_first_; }
  bool may_stand(const Place& place) const;
  /// True if the straight path keeps the required distance from boards, or at least that at its start.
  bool may_drive(const Place& from, const Place& to) const;

 private:
  double distance_from_boards(double x_m, double y_m) const;

  double clearance_m_;
  Rigid3 T_world_first_;
  DriveArea area_;
  std::vector<Footprint> boards_;
};

/// Whole degrees and centimetres; forwards or backwards, whichever needs smaller turns; turns below the smallest one
/// are omitted if so asked.
/// @param about_m where in its frame the robot turns
DriveCommand command_between(const Place& from, const Place& to, double min_turn_rad, const Eigen::Vector2d& about_m);

}  // namespace rigproof::suggest
