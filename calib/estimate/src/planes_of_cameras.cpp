#include "planes_of_cameras.h"

#include <algorithm>
#include <utility>

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
    result[axis] = median_of(std::move(values));
  }
  return result;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rigproof
