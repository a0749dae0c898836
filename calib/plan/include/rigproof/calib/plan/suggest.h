// Where the robot should go next: the few stops that reduce the worst uncertainty most, as drive commands.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// The criterion to minimise: a function of the covariance of all cameras in the robot, with lengths and angles in
/// units of SuggestOptions::limits.
enum class SuggestCriterion {
  kWorstAxis,    ///< the largest standard deviation of any camera's axis
  kDeterminant,  ///< D-optimal: the volume of the uncertainty
  kEigenvalue,   ///< E-optimal: the largest principal axis of the uncertainty
};

/// A rectangle of free floor [m], in the frame of the robot at the first stop.
struct DriveArea {
  double x_min_m = 0.0;
  double x_max_m = 0.0;
  double y_min_m = 0.0;
  double y_max_m = 0.0;
};

struct SuggestOptions {
  int stops = 3;
  SuggestCriterion criterion = SuggestCriterion::kWorstAxis;
  /// Standard deviations that count as equally bad. Observations::accept replaces them if it is given.
  AcceptLimits limits{0.005, 0.003, 0.00174533};
  /// Where the robot may stand; absent: within reach_m of the rectangle in which it has stood.
  std::optional<DriveArea> area;
  double reach_m = 1.0;
  double clearance_m = 1.0;         ///< of the robot's origin from the board, on the way too
  double min_turn_rad = 0.0523598;  ///< smaller turns are not asked for (3 degrees)
  int min_cameras = 1;              ///< that see the whole board from every stop
  double max_obliquity_rad = 1.05;  ///< between the board's normal and the view
  int candidates = 300;             ///< places among which is chosen
  /// By which a stop must make the criterion smaller [share of a standard deviation]; others are not suggested.
  double min_gain = 0.01;
  std::uint64_t seed = 0;  ///< of the places
  /// [camera] where it is mounted by the robot's drawings, if they are known: where it looks before it saw the board.
  std::vector<std::optional<Rigid3>> T_robot_camera_as_mounted = {};
  MlOptions ml;  ///< as the calibration is asked for: its priors count, now and then
};

/// What a robot on wheels does: turn, drive straight, turn. Turns are positive to the left.
struct DriveCommand {
  double turn_before_rad = 0.0;
  double distance_m = 0.0;  ///< negative: backwards
  double turn_after_rad = 0.0;
  Eigen::Vector2d about_m = Eigen::Vector2d::Zero();  ///< where in its frame it turns

  Rigid3 motion() const;  ///< T_before_after of its origin
  /// "turn 34 deg left, drive 1.20 m, turn 10 deg right", "turn 140 deg left on the spot".
  std::string text() const;
};

struct SuggestedStop {
  DriveCommand command;      ///< from the stop before, the first from the last one of the observations
  Rigid3 T_world_robot;      ///< planar
  std::vector<int> cameras;  ///< that will see the whole board
  std::vector<int> hoped;    ///< that have not seen it and may see it from there
};

/// Standard deviations tx ty tz rx ry rz [m, rad]; absent: not determined.
using AxisSigmas = std::array<std::optional<double>, 6>;

struct CameraForecast {
  std::string camera;
  AxisSigmas now;
  AxisSigmas then;
};

struct Suggestion {
  std::vector<SuggestedStop> stops;
  std::vector<CameraForecast> cameras;  ///< those that saw the board
  AcceptLimits limits;                  ///< that weighed
  ResultStatus status_now = ResultStatus::kRefused;
  ResultStatus status_then = ResultStatus::kRefused;  ///< of `ml` on the observations with the forecast ones
  std::vector<Finding> reasons_now;
  std::vector<Finding> reasons_then;
  bool nothing_helps = false;  ///< fewer stops than asked for, since no further one would make the criterion smaller
  /// Why fewer stops than asked for are suggested, or what the forecast leaves out.
  std::vector<Finding> notes;
  /// As estimated. Undetermined x, y or yaw have small, consistent values.
  Rigid3 T_world_board;
  std::vector<Rigid3> T_world_robot;  ///< of the stops so far
};

/// First come turns on the spot for cameras in whose images no board was found. Places are drawn on the free floor,
/// aimed so that a camera sees the whole board, beside turns where the robot stands; the best ones are chosen one by
/// one (greedy; of those about as good the nearest) and then exchanged as long as that helps. The information of a stop
/// is that of `ml`, linearised at the estimate with its noise levels; the covariances of its views are those of the
/// nearest views so far, and the odometry links it to the previous stop. Works from a refused result as well:
/// undetermined directions count as one metre or radian. Throws Error on options out of range, and where no camera ever
/// saw the board.
Suggestion suggest_stops(const Observations& observations, const SuggestOptions& options = {});

}  // namespace rigproof
