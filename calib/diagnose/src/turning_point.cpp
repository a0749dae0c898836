#include "rigproof/calib/diagnose/turning_point.h"

#include <algorithm>

namespace rigproof {

double variance_beside_turning_point(const EstimatedTransform& camera, std::size_t axis) {
  double rest = 1.0;
  for (const EstimatedTransform::Share& line : camera.budget)
    if (line.source == "turning point") rest -= line.share[axis];
  const Eigen::Index i = static_cast<Eigen::Index>(axis);
  return std::max(0.0, rest) * (*camera.covariance)(i, i);
}

}  // namespace rigproof
