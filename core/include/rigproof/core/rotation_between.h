#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rigproof {

/// Smallest rotation that turns one direction into the other; any length. Eigen's FromTwoVectors, compiled once: it
/// brings a singular value decomposition, which takes ten seconds to compile wherever it is called.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace rigproof
