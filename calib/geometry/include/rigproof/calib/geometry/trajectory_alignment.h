// The vertical from the cameras' motion relative to the board, and the planes that are therefore the ground.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof {

/// Where the vertical was taken from.
enum class VerticalSource {
  kMotion,  ///< rotation axis and plane of the cameras' motion
  kGround,  ///< normals of the ground planes, because the motion leaves the vertical open
  kNone,    ///< neither tells
};

/// The robot moves on a plane, so in the board frame every camera turns about one axis and stays at one height; in a
/// camera the vertical is one constant direction. Both hold for any lever arm between robot and camera.
struct TrajectoryAlignment {
  VerticalSource source = VerticalSource::kNone;          ///< of several boards: the best that any of them has
  std::vector<Eigen::Vector3d> up_board;                  ///< vertical in the frame of each board
  std::vector<std::optional<Eigen::Vector3d>> up_camera;  ///< per camera; absent without a view (or plane) to tell
  double sigma_up_rad = 0.0;  ///< standard deviation of the worst direction of the vertical, where it is known best
  std::vector<double> sigma_up_camera_rad;  ///< the same per camera, of those that have one
  /// Per view, 0 to 1: how well it fits the common planar motion; below kLeastPlanarWeight it contradicts it.
  std::vector<double> view_weights;
};

/// Of a view that fits the common planar motion.
inline constexpr double kLeastPlanarWeight = 0.05;

/// Rotation that takes `up` to z.
Eigen::Matrix3d levelling(const Eigen::Vector3d& up);

/// Closed form: up is the smallest eigenvector of a 3x3 matrix made of all cameras' rotations and positions,
/// reweighted until views that contradict the planar motion (a flipped board pose) count no more. The sign comes
/// from the odometry's turns, or where there are none from its path, or from the ground planes. Of several boards each
/// tells on its own; from the one that knows the vertical best it spreads to the cameras that see it, and from these to
/// their other boards.
TrajectoryAlignment align_trajectories(const Observations& observations, const std::vector<ViewPose>& views);

struct GroundCheckOptions {
  /// Largest angle between a plane's normal and the vertical, on top of 3 sigma of both [rad].
  double max_angle_rad = 0.07;
  /// Planes of one camera agree in height within this, on top of 4 sigma [m]: suspension and unevenness.
  double max_height_difference_m = 0.03;
};

/// Which of Observations::ground_planes are the ground.
struct GroundCheck {
  std::vector<bool> accepted;  ///< per ground plane
  std::vector<Exclusion> rejected;
  int count(const Observations& observations, int camera) const;
  /// The accepted ones.
  std::vector<PlaneObservation> planes(const Observations& observations) const;
};

/// Rejects walls and ceilings by their normal against the vertical of the motion, tables by their height.
GroundCheck check_ground_planes(const Observations& observations, const TrajectoryAlignment& alignment,
                                const GroundCheckOptions& options = {});

/// Height of the camera above a plane and its standard deviation [m], from the inverse-depth form.
struct PlaneHeight {
  double height_m = 0.0;
  double sigma_m = 0.0;
};
PlaneHeight height_above(const PlaneObservation& plane);

}  // namespace rigproof
