// Other intrinsics, and what registered depth images show through them.
#pragma once

#include <Eigen/Core>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Whether a plane comes from a depth image that is registered to the colour camera: its rays are by the stated
/// intrinsics then, and err with them. Clouds are made with the sensor's own, and planes without a file (drawn, not
/// seen) are taken for exact.
bool is_registered(const PlaneObservation& plane, const RigCamera& camera);

/// A lens whose focal lengths are longer by change[0] (relative) and whose principal point lies (change[1], change[2])
/// px away.
Camera changed_lens(Camera lens, const Eigen::Vector3d& change);

/// Derivative of a registered plane [1/m] by such a change: 1/z = a . K^-1 u holds for every pixel u, so that other
/// intrinsics K' make (K^-1 K')' a of a. Linear in the change.
Eigen::Matrix3d plane_by_lens(const Eigen::Vector3d& plane_per_m, const Camera& lens);

/// Gives a camera other intrinsics, and its registered planes what they are by those.
void change_lens(int camera, const Eigen::Vector3d& change, Observations* observations);

}  // namespace rigproof::ml
