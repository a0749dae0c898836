// Numbers as files of a tree of frames have them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "rigproof/core/rigid3.h"

namespace rigproof::exporting {

/// Ten decimals without trailing zeros: a tenth of a nanometre, and less at the end of any lever on a robot.
std::string decimal_text(double value);
/// "x y z", as URDF has it.
std::string vector_text(const Eigen::Vector3d& values);

/// An <origin>: R = Rz(yaw) Ry(pitch) Rx(roll).
struct UrdfPose {
  Eigen::Vector3d xyz_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy_rad = Eigen::Vector3d::Zero();

  Rigid3 transform() const;
};
UrdfPose urdf_pose(const Rigid3& T);

/// Pose of an optical frame in the axes of its camera's body (x forward, y left, z up), both in the optical centre.
Rigid3 body_from_optical();

/// Row by row, a line each, with all digits.
std::string matrix_text(const Eigen::Matrix4d& matrix);

}  // namespace rigproof::exporting
