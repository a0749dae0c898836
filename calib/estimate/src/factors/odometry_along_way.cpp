// Odometry from one stop to the next along the way, whose noise and yaw factor bend what follows.
#include "../factors.h"

namespace rigproof::ml {

// Translation and heading share the residuals: a group's part is what its noise is of each residual's variance.
void odometry_along_way(const Evaluation& at, int to, const OdometryWay& way, BlockSink* sink) {
  const WayNoise shape = way_noise(way, at.noise, at.stop(to - 1), at.stop(to));
  const IncrementResidual residual = way_residual(at.pose(to - 1), at.pose(to), at.state.odometry_errors(), way);
  LocalBlock block(Group::kOdometryXy, 0);
  BlockRows rows(&block);
  rows.add(of_pose(to - 1, 0, 3), residual.by_from);
  rows.add(of_pose(to, 0, 3), residual.by_to);
  rows.add(at.layout, Nuisance::kOdometryFactors, 0, residual.by_factors);
  rows.add(at.layout, Nuisance::kOdometryVeer, 0, residual.by_veer);
  rows.whiten(shape.whitening);
  add_shared(at, {Group::kOdometryXy, Group::kOdometryYaw}, shape.heading, shape.whitening * residual.value, rows,
             &block, sink);
}

}  // namespace rigproof::ml
