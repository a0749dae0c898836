// A robot that really drives from viewpoint to viewpoint, and what its cameras' clock and its wheels made of it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/motion.h"
#include "rigproof/generator/route.h"
#include "rigproof/generator/wheel_odometer.h"
#include "rigproof/sim/physics.h"

namespace rigproof {

/// An instant at which cameras expose.
struct Capture {
  double stamp_s = 0.0;
  Rigid3 T_scene_robot;  ///< all six degrees of freedom, from physics
};

/// A way that came to nothing, and why.
struct DriveTrouble {
  enum class Kind {
    kTouches,
    kTippedOver,
    kDoesNotTurn,
    kDoesNotGetOn,
    kEndsTooFar,   ///< however often it corrects its place
    kDoesNotRest,  ///< at the viewpoint
    kNoWay,        ///< not even planned
    kNoOtherWay    ///< than those that failed
  };
  std::size_t goal = 0;  ///< of those asked for, in order, the replacements included
  FloorPose at;          ///< where the robot was
  Kind kind = Kind::kTouches;
  std::string what;  ///< touched, or in between

  bool lacks_way() const { return kind == Kind::kNoWay || kind == Kind::kNoOtherWay; }
  /// "touches shelf", "tipped over", "stuck: ..", "no way: .. is in between,"
  std::string text() const;
};

/// The drive as it happened. What failed and was taken back is in `troubles` alone.
struct Drive {
  std::vector<FloorPose> reached;  ///< viewpoints, as planned
  std::vector<Capture> captures;   ///< standing: one for each of `reached`
  std::vector<OdometrySample> odometry;
  RobotTrajectory trajectory;
  Rigid3 T_ground_robot;  ///< at rest on flat ground: see DrivePhysics
  std::vector<DriveTrouble> troubles;
  std::size_t ways_tried_again = 0;  ///< as many as troubles
  std::size_t given_up = 0;          ///< viewpoints for which no plan worked
  std::size_t corrections = 0;       ///< times that the robot had to correct its place at a viewpoint
  double worst_position_m = 0.0;     ///< at rest, from the plan
  double worst_heading_rad = 0.0;
  double duration_s = 0.0;
};

struct DriveRequest {
  DriveConfig config;
  WheelGeometry wheels;
  double odometry_rate_hz = 50.0;
  FloorArea area;
  std::vector<FloorPose> goals;
  /// Of the goals the last: frames of a straight drive, which come after all viewpoints and cannot be replaced.
  std::size_t straight_goals = 0;
  /// Another viewpoint for one that was given up; nothing where there is none to give. Called a bounded number of
  /// times.
  std::function<std::optional<FloorPose>()> replacement;
  /// Told of the viewpoints reached; return false to interrupt.
  std::function<bool(std::size_t)> progress;
};

/// Drives through all goals, from the first one, where the robot stands at the beginning. Feedback is the true pose, as
/// of a perfect localisation: what is under test is the recording, not the navigation. A way on which the robot touches
/// something, tips over, is stuck or ends elsewhere is taken back to the last viewpoint and another one is tried, at
/// most max_plans; then the viewpoint is replaced or, if nothing can replace it, the request is refused. Throws Error
/// that names the viewpoint and what happened on every plan.
Drive simulate_drive(DrivePhysics& physics, const DriveRequest& request);

}  // namespace rigproof
