// Odometry from one stop to the next as one motion, whose error does not depend on the way.
#include "../factors.h"

namespace rigproof::ml {

void odometry_increment(const Evaluation& at, int to, const VeeringIncrement& measured, BlockSink* sink) {
  const Eigen::Vector3d inverse = odometry_sigmas(at.observations, at.noise, to).cwiseInverse();
  const IncrementResidual residual =
      increment_residual(at.pose(to - 1), at.pose(to), at.state.odometry_errors(), measured);
  LocalBlock block(Group::kOdometryXy, 0);
  BlockRows rows(&block);
  rows.add(of_pose(to - 1, 0, 3), residual.by_from);
  rows.add(of_pose(to, 0, 3), residual.by_to);
  rows.add(at.layout, Nuisance::kOdometryFactors, 0, residual.by_factors);
  rows.add(at.layout, Nuisance::kOdometryVeer, 0, residual.by_veer);
  rows.whiten(inverse.asDiagonal());
  const Eigen::Matrix3d yaw = Eigen::Vector3d::UnitZ().asDiagonal();
  add_shared(at, {Group::kOdometryXy, Group::kOdometryYaw}, yaw, inverse.cwiseProduct(residual.value), rows, &block,
             sink);
}

}  // namespace rigproof::ml
