// Planes sorted by the camera that saw them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

using PlanesOfCamera = std::vector<const PlaneObservation*>;

/// The planes of each camera, in their order; they point into `planes`.
std::vector<PlanesOfCamera> planes_of_cameras(const std::vector<PlaneObservation>& planes, std::size_t cameras);

/// The median of each component of one or more inverse-depth planes [1/m].
Eigen::Vector3d median_plane(const PlanesOfCamera& planes);

}  // namespace rigproof
