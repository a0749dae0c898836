// Closed-form start from the data alone, for any mounting of 1 to 8 cameras and any pose of the board.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct InitialGuess {
  std::vector<std::optional<Rigid3>> T_robot_camera;  ///< absent for a camera that never saw the board
  std::optional<Rigid3> T_world_board;                ///< of the first board; absent if no camera ever saw any
  std::vector<Rigid3> T_world_more_boards;            ///< of the others; one that no camera saw lies anywhere
  /// Planar poses (z, roll, pitch zero), the world being the robot's frame at the first stop: from the board where a
  /// camera saw it, continued by odometry elsewhere.
  std::vector<Rigid3> T_world_robot;
};

/// Levels all views by the vertical, then solves the planar hand-eye equations of all cameras together:
///   a = R(psi) B + t_k - R(delta) t_l
/// with a the odometry from a stop seen by camera k to one seen by camera l, B the same in the board's levelled frame,
/// delta the CAMERAS' turn; linear in (t_1 .. t_K, cos psi, sin psi); then the t again with psi fixed. Links between
/// cameras at one stop need no odometry; cameras without overlap are linked through the odometry. Where the motion
/// leaves degrees of freedom open (see observability.h) they take small, consistent values, so camera-to-camera
/// transforms are still right. Heights come from the accepted ground planes; without any, the lowest camera is put at
/// height zero. Links are between views of one board; cameras that no chain of boards joins are solved apart.
InitialGuess initial_guess(const Observations& observations, const std::vector<ViewPose>& views,
                           const TrajectoryAlignment& alignment, const GroundCheck& ground);

}  // namespace rigproof
