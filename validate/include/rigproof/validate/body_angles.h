// Roll, pitch and yaw of a camera's body axes (x forward, y left, z up), beside the optical ones.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Rotation R_optical_body: body axes (x forward, y left, z up) written in optical axes (x right, y down, z forward).
Eigen::Quaterniond optical_from_body();

/// (roll, pitch, yaw) in radians of R = Rz(yaw) Ry(pitch) Rx(roll); at pitch +-90 degrees roll is 0.
Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles);

/// Difference of roll, pitch and yaw of the camera's body axes, wrapped to (-pi, pi]: how the paper's tables read a
/// rotation error. `between_cameras`: the parent's axes are a camera's too and are turned to its body axes.
Eigen::Vector3d roll_pitch_yaw_error(const Rigid3& T_estimate, const Rigid3& T_true, bool between_cameras);

/// T_robot_camera with the degrees that are not observable taken from the truth: translations along the parent's axes,
/// rotations as roll, pitch, yaw of the camera's body axes, as result.h defines them.
Rigid3 with_unobservable_from(const Rigid3& T_true, const Rigid3& T_estimate, const std::array<bool, 6>& observable);

}  // namespace rigproof
