// The plane that the authors' program of MEMROC takes from a cloud.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rigproof::rivals {

/// n . p + d = 0; the sign of n is that of the sample it came from, as PCL leaves it.
struct CloudPlane {
  Eigen::Vector3d normal;
  double d = 0.0;
};

/// PCL's RANSAC: of 50 samples the plane with the most points within 0.1 mm, fitted to these, whatever it is: floor,
/// wall or ceiling. On a sensor's noise 0.1 mm holds few points, so that height and tilt are nearly those of three of
/// them. Absent where no three points span a plane. The same for the same points.
std::optional<CloudPlane> largest_plane(const std::vector<Eigen::Vector3f>& points);

}  // namespace rigproof::rivals
