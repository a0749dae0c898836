#include "directions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rigproof/core/median.h"

namespace rigproof::rivals {

using Eigen::Vector3d;

void Directions::add(const Vector3d& vector, double weight) {
  vectors.push_back(vector);
  weights.push_back(weight);
}

std::optional<Vector3d> Directions::common() const {
  if (vectors.size() < kMinDirections) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < vectors.size(); ++i) mean += weights[i] * vectors[i];
  for (int round = 0; round < 20 && mean.norm() > 0.0; ++round) {
    mean.normalize();
    std::vector<double> angles;
    for (const Vector3d& v : vectors) angles.push_back(std::atan2(v.cross(mean).norm(), v.dot(mean)));
    const double scale = std::max(1e-6, 3.0 * median(angles));
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < vectors.size(); ++i)
      sum += weights[i] / (1.0 + angles[i] * angles[i] / (scale * scale)) * vectors[i];
    mean = sum;
  }
  if (!(mean.norm() > 0.0)) return std::nullopt;
  return mean.normalized();
}

}  // namespace rigproof::rivals
