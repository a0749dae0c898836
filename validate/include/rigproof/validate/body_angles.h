// Roll, pitch and yaw of a camera's body axes, their differences and their uncertainty (core/body_axes.h).
#pragma once

#include <Eigen/Core>
#include <array>

#include "rigproof/core/body_axes.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// Difference of roll, pitch and yaw of the camera's body axes, wrapped to (-pi, pi]: how the paper's tables read a
/// rotation error. `between_cameras`: the parent's axes are a camera's too and are turned to its body axes.
Eigen::Vector3d roll_pitch_yaw_error(const Rigid3& T_estimate, const Rigid3& T_true, bool between_cameras);

/// T_robot_camera with the degrees that are not observable taken from the truth: translations along the parent's axes,
/// rotations as roll, pitch, yaw of the camera's body axes, as result.h defines them.
Rigid3 with_unobservable_from(const Rigid3& T_true, const Rigid3& T_estimate, const std::array<bool, 6>& observable);

/// Roll, pitch, yaw [rad] of a camera's body axes in the robot frame.
Eigen::Vector3d camera_roll_pitch_yaw(const Eigen::Quaterniond& rotation_robot_camera);

/// Six standard deviations of a camera's pose in the robot: translation [m], then those of camera_roll_pitch_yaw();
/// 0 = none stated.
Vector6d pose_sigmas(const EstimatedTransform& transform);

}  // namespace rigproof
