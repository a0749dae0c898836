// The plane that the authors' program of MEMROC takes from a cloud.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/random.h"

namespace rigproof::rivals {

/// n . p + d = 0; the sign of n is that of the sample it came from, as RANSAC implementations leave it.
struct CloudPlane {
  Eigen::Vector3d normal;
  double d = 0.0;
};

/// The plane with the most points within 0.1 mm, whatever it is: floor, wall or ceiling. Absent where no three points
/// span one.
std::optional<CloudPlane> largest_plane(const std::vector<Eigen::Vector3f>& points, RandomStream random);

}  // namespace rigproof::rivals
