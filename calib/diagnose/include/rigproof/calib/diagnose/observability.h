// What the data can answer, per degree of freedom.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/estimate/ml_options.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Kind of motion, as far as it matters for calibration.
enum class MotionKind {
  kSufficient,
  kTooFewPoses,  ///< fewer than three
  kStandstill,
  kNoTurning,    ///< straight lines: x and y open, yaw known
  kTurnInPlace,  ///< about the robot's own origin
  kOneCentre,    ///< arcs about one centre
};

/// Gate 1 of the refusal rules.
struct MotionVerdict {
  MotionKind kind = MotionKind::kTooFewPoses;
  /// Smallest generalised eigenvalue of the planar hand-eye matrix over its expectation under PnP noise: about 1 for
  /// a degenerate drive whatever the noise, kMotionGate and more for one that determines x, y and yaw.
  double gate = 0.0;
  int usable_poses = 0;
  std::optional<Eigen::Vector2d> centre_m;  ///< in robot, for kTurnInPlace and kOneCentre
  bool xy = false;                          ///< x and y of the camera in the robot are determined
  bool yaw = false;
  std::optional<Finding> finding;  ///< why not; absent if sufficient
};

inline constexpr double kMotionGate = 5.0;

/// Judges the motion from the given cameras' views of the board, without the odometry (which only serves to name the
/// centre). Views that contradict the planar motion are ignored.
/// @param cameras indices; the cameras of a method that solves them jointly, or a single one.
MotionVerdict assess_motion(const Observations& observations, const std::vector<ViewPose>& views,
                            const TrajectoryAlignment& alignment, const InitialGuess& guess,
                            const std::vector<int>& cameras);

/// What can be known about one camera in the robot: tx ty tz rx ry rz.
struct CameraObservability {
  std::array<bool, 6> observable = {false, false, false, false, false, false};
  std::vector<Finding> findings;  ///< one for each reason that something is not
  bool all() const;
  bool any() const;
};

/// Combines the motion with the vertical and the ground.
/// @param motion of this camera, or of the rig where cameras are solved jointly
/// @param ground_planes accepted planes that fix this camera's height (its own, or the rig's)
CameraObservability assess_camera(const Observations& observations, int camera, const std::vector<ViewPose>& views,
                                  const TrajectoryAlignment& alignment, const MotionVerdict& motion, int ground_planes);

/// Clears the flags of degrees whose standard deviation exceeds the limit, and says so.
void apply_posterior_gate(const Matrix6d& covariance, const std::string& camera, CameraObservability* observability,
                          const PosteriorLimits& limits = {});

}  // namespace rigproof
