// How a camera, or a board that faces the robot, stands in a frame whose x looks forward.
#pragma once

#include <Eigen/Geometry>

namespace rigproof {

/// R_body_optical: body x is optical z, y is -x, z is -y.
inline Eigen::Quaterniond looking_forward() {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::Quaterniond(R);
}

}  // namespace rigproof
