// The cameras on their robot, in three dimensions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "inspect_space.h"
#include "rigproof/study/report/inspect.h"

namespace rigproof::inspect_detail {

/// Where a camera is, as far as truth and result tell.
struct MountedCamera {
  std::size_t index = 0;  ///< in the observations
  std::optional<Rigid3> T_true, T_estimate;
  std::optional<Matrix6d> covariance;  ///< of T_estimate, chart of transform_error()

  bool is_known() const { return T_true || T_estimate; }
  /// Of a camera that is known: the true pose, else the estimate.
  const Rigid3& best() const { return T_true ? *T_true : *T_estimate; }
};
struct MountedRig {
  std::string method;  ///< that estimated; empty without an estimate
  std::vector<MountedCamera> cameras;
};
/// As ml estimated, else the first result that has the pose of a camera.
MountedRig mounted_rig(const InspectInput& input);

/// Length of a camera's frustum in the picture [m]: a part of the rig's size.
double frustum_length(const MountedRig& rig);
/// How many times too long errors and sigmas are drawn: 1, 2 or 5 times a power of ten, so that the largest is about as
/// long as a camera is wide; 1 where they are that long as they are.
double exaggeration(const MountedRig& rig);
/// Whether the estimate is so far from the truth that the picture shows it as it is.
bool is_striking(const MountedCamera& camera, double length_m);
/// The estimate with its error so many times as large; as it is without truth.
Rigid3 exaggerated(const MountedCamera& camera, double factor);

struct Frustum {
  Eigen::Vector3d apex;
  std::vector<Eigen::Vector3d> mouth;  ///< top left, top right, bottom right, bottom left of the image
  std::vector<Eigen::Vector3d> roof;   ///< triangle on the image's upper side, which tells it from the lower one
};
Frustum frustum_of(const Camera& camera, const Rigid3& T_robot_camera, double length_m);

/// "looks 25 deg left, 12 deg down".
std::string looks(const Rigid3& T_robot_camera);
/// "upside down", "on its side", or nothing where its image is upright, or where it looks straight up or down.
std::string unusual_roll(const Rigid3& T_robot_camera);

/// Ground, robot, cameras and boards that are near, in the robot's frame.
struct RigShapes {
  std::vector<Shape> ground, solid;
  std::array<double, 3> axes_m{};  ///< lengths of the frame's axes: beyond the robot's body
  double grid_m = 0.0;             ///< side of the ground's squares
  std::optional<int> stop;         ///< where boards are as far from the robot as drawn

  std::vector<Eigen::Vector3d> axes() const;  ///< their tips
  std::vector<Eigen::Vector3d> seen() const;  ///< all points
};
RigShapes rig_shapes(const InspectInput& input, const MountedRig& rig, double factor);

}  // namespace rigproof::inspect_detail
