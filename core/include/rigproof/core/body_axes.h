// A camera's body axes (x forward, y left, z up) beside its optical ones, and roll, pitch and yaw.
#pragma once

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Rotation R_optical_body: body axes (x forward, y left, z up) written in optical axes (x right, y down, z forward).
Eigen::Quaterniond optical_from_body();

/// (roll, pitch, yaw) in radians of R = Rz(yaw) Ry(pitch) Rx(roll), as URDF has them; at pitch +-90 degrees roll is 0.
/// Together they give R back to rounding, near that pole, too.
Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles);

}  // namespace rigproof
