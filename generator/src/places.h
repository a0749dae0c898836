// Places of the robot: whether it may stand there, and which cameras see which board from there.
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

/// A camera with a whole board in its image.
struct Sight {
  std::size_t camera = 0, board = 0;
};

/// The places around the subject's boards. Poses and points are in the scene's frame.
class Places {
 public:
  Places(const ViewpointConfig& config, const ViewpointSubject& subject, ViewpointWorld& world);

  /// @param board that distance, bearing and heading are told from
  Viewpoint place(double distance_m, double bearing_rad, double heading_rad, std::size_t board = 0) const;
  Viewpoint at(double x_m, double y_m, double yaw_rad) const;
  /// Below the first board's centre, x towards its viewers.
  Rigid3 board_on_floor() const;
  std::size_t boards() const { return boards_.size(); }
  const Eigen::Vector3d& board_centre(std::size_t board) const { return boards_[board].centre; }

  bool inside(const Viewpoint& stop) const;
  /// The cameras that have a whole board in their image, with border and margin, and not too obliquely, each with the
  /// one that has the most corners; something may stand in between.
  std::vector<Sight> facing(const Viewpoint& stop) const { return sights(stop, false); }
  /// The same with nothing in between.
  std::vector<Sight> seeing(const Viewpoint& stop) const { return sights(stop, true); }
  /// Fills in what the cameras see. The first constraint that leaves fewer than `needed` cameras is the answer.
  std::optional<Rejection> look(int needed, Viewpoint* stop) const;
  /// The same, and whether the robot may stand there.
  std::optional<Rejection> check(int needed, Viewpoint* stop) const;

 private:
  struct Placed {
    int corners = 0;
    Eigen::Vector3d outward, centre;
    double facing_rad = 0.0;
    std::vector<Eigen::Vector3d> outline, sight_points;

    explicit Placed(const ViewedBoard& board);
    // Angle between the board's normal and the line to the camera; beyond 90 degrees it sees the back.
    double obliquity(const Eigen::Vector3d& origin) const;
  };

  bool has_whole(const Placed& board, const Camera& camera, const Rigid3& T_scene_camera) const;
  bool is_oblique(const Placed& board, const Eigen::Vector3d& origin) const;
  bool in_sight(std::size_t board, const Eigen::Vector3d& origin) const;
  std::vector<Sight> sights(const Viewpoint& stop, bool with_what_hides) const;

  const ViewpointConfig& config_;
  const ViewpointSubject& subject_;
  ViewpointWorld& world_;
  FloorArea area_;
  std::vector<Placed> boards_;
};

}  // namespace rigproof
