#include "planes_of_cameras.h"

#include <utility>

#include "rigproof/core/median.h"

namespace rigproof {

std::vector<PlanesOfCamera> planes_of_cameras(const std::vector<PlaneObservation>& planes, std::size_t cameras) {
  std::vector<PlanesOfCamera> result(cameras);
  for (const PlaneObservation& plane : planes) result[static_cast<std::size_t>(plane.camera)].push_back(&plane);
  return result;
}

Eigen::Vector3d median_plane(const PlanesOfCamera& planes) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const PlaneObservation* plane : planes) values.push_back(plane->inverse_depth_plane[axis]);
    result[axis] = median(std::move(values));
  }
  return result;
}

}  // namespace rigproof
