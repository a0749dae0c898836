// Changed intrinsics, and their effect on planes of registered depth images.
#pragma once

#include <Eigen/Core>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Whether a plane comes from a depth image that is registered to the colour camera: its rays then use the stated
/// intrinsics, and share their error. Clouds use the sensor's own intrinsics; simulated planes (without a file) are
/// exact.
bool is_registered(const PlaneObservation& plane, const RigCamera& camera);

/// A lens with focal lengths longer by change[0] (relative) and the principal point moved by (change[1], change[2]) px.
Camera changed_lens(Camera lens, const Eigen::Vector3d& change);

/// Derivative of a registered plane [1/m] by such a change: 1/z = a . K^-1 u holds for every pixel u, so intrinsics K'
/// turn a into (K^-1 K')' a. Linear in the change.
Eigen::Matrix3d plane_by_lens(const Eigen::Vector3d& plane_per_m, const Camera& lens);

/// Changes a camera's intrinsics and, accordingly, its registered planes.
void change_lens(int camera, const Eigen::Vector3d& change, Observations* observations);

}  // namespace rigproof::ml
