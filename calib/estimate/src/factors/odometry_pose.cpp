// Odometry that knows each stop's pose in its world.
#include <cmath>

#include "../factors.h"
#include "rigproof/calib/estimate/residuals.h"

namespace rigproof::ml {

Eigen::Vector3d odometry_sigmas(const Observations& observations, const NoiseLevels& noise, int stop) {
  double xy2 = noise.odometry_xy_m * noise.odometry_xy_m;
  const auto add = [&](int i) {
    const double interpolation = observations.stops[static_cast<std::size_t>(i)].interpolation_sigma_m;
    xy2 += interpolation * interpolation;
  };
  add(stop);
  if (noise.law.model == OdometryModel::kPerIncrement) add(stop - 1);
  const double xy = std::sqrt(xy2);
  return {xy, xy, noise.odometry_yaw_rad};
}

void odometry_pose(const Evaluation& at, int stop, BlockSink* sink) {
  const Eigen::Vector3d inverse = odometry_sigmas(at.observations, at.noise, stop).cwiseInverse();
  const PoseResidual residual =
      pose_residual(at.pose(stop), at.stop(stop), at.observations.odometry_noise.rotation_centre_m);
  LocalBlock block(Group::kOdometryXy, 0);
  BlockRows rows(&block);
  rows.add(of_pose(stop, 0, 3), Eigen::Matrix3d(inverse.asDiagonal() * residual.by_pose));
  const Eigen::Matrix3d yaw = Eigen::Vector3d::UnitZ().asDiagonal();
  add_shared(at, {Group::kOdometryXy, Group::kOdometryYaw}, yaw, inverse.cwiseProduct(residual.value), rows, &block,
             sink);
}

}  // namespace rigproof::ml
