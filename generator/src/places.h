// Places of the robot: whether it may stand there, and what its cameras see of the board from there.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/generator/viewpoints.h"

namespace rigproof {

enum Rejection : std::size_t { kOutside, kCutOff, kOblique, kCollision, kHidden, kRejections };

/// How many candidates each constraint turned down.
struct Tally {
  std::array<std::size_t, kRejections> rejected{};
  std::size_t candidates = 0;

  /// "83 % lie outside of ..., 12 % touch something".
  std::string text() const;
  /// What to change, of the constraint that turned down most.
  const char* remedy() const;
};

/// The places around a board. Poses and points are in the scene's frame.
class Places {
 public:
  Places(const ViewpointConfig& config, const ViewpointSubject& subject, ViewpointWorld& world);

  Viewpoint place(double distance_m, double bearing_rad, double heading_rad) const;
  Viewpoint at(double x_m, double y_m, double yaw_rad) const;
  /// Below the board's centre, x towards its viewers.
  Rigid3 board_on_floor() const { return planar_pose(centre_.x(), centre_.y(), facing_rad_); }
  const Eigen::Vector3d& board_centre() const { return centre_; }

  bool inside(const Viewpoint& stop) const;
  /// True if a camera has the whole board in its image, with border and margin, and not too obliquely; something may
  /// stand in between.
  bool faces(std::size_t camera, const Viewpoint& stop) const;
  /// The cameras that see it so, with nothing in between.
  std::vector<std::size_t> seeing(const Viewpoint& stop) const;
  /// Fills in what the cameras see. The first constraint that leaves fewer than `needed` cameras is the answer.
  std::optional<Rejection> look(int needed, Viewpoint* stop) const;
  /// The same, and whether the robot may stand there.
  std::optional<Rejection> check(int needed, Viewpoint* stop) const;

 private:
  bool has_whole_board(const Camera& camera, const Rigid3& T_scene_camera) const;
  bool is_oblique(const Eigen::Vector3d& origin) const;
  // Angle between the board's normal and the line to the camera; beyond 90 degrees it sees the back.
  double obliquity(const Eigen::Vector3d& origin) const;
  bool board_in_sight(const Eigen::Vector3d& origin) const;

  const ViewpointConfig& config_;
  const ViewpointSubject& subject_;
  ViewpointWorld& world_;
  FloorArea area_;
  Eigen::Vector3d outward_, centre_;
  double facing_rad_ = 0.0;
  std::vector<Eigen::Vector3d> outline_, sight_points_;
};

}  // namespace rigproof
