// The ground in the depth of one stop: predicted minus measured inverse-depth plane.
#include "../factors.h"

namespace rigproof::ml {

void ground_plane(const Evaluation& at, const WhitenedPlane& plane, BlockSink* sink) {
  const int c = plane.camera;
  const NuisanceValues& values = at.state.nuisances;
  const MeasuredPlane measured = measured_plane(at, plane);
  const GroundResidual residual =
      ground_residual(at.T_robot_camera(c, plane.stop), at.pose(plane.stop), depth_error(at, c), measured.value);
  const Eigen::Matrix3d W = plane.whitening / at.noise.ground_scale[static_cast<std::size_t>(c)];
  const Eigen::Vector3d r = W * (residual.value + values.of(Nuisance::kGroundOffset, c));
  const double s = r.squaredNorm(), w = at.loss.weight(s);

  LocalBlock block(Group::kGround, c);
  BlockRows rows(&block);
  rows.add(at.camera_unknowns(c, plane.stop), residual.by_camera);
  rows.add(of_pose(plane.stop), residual.by_pose);
  rows.add(at.layout, Nuisance::kDepthScale, c, residual.by_depth_bias);
  const CommonDepth common = common_depth(at.observations, c);
  rows.add(at.layout, Nuisance::kCommonDepthScale, common.camera, (common.share * residual.by_depth_bias).eval());
  rows.add(at.layout, Nuisance::kLens, c, (-measured.by_lens).eval());
  rows.add(at.layout, Nuisance::kDepthOffset, c, (-measured.by_offset).eval());
  rows.add(at.layout, Nuisance::kDepthShape, c, (-measured.by_shape).eval());
  rows.add(at.layout, Nuisance::kGroundOffset, c, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  rows.whiten(W);
  block.cost = at.loss.cost(s);
  block.sum.add(s, w, 3);
  rows.set_normal(r, block_factor(at.weighting, w, 3));
  sink->add(block);
}

}  // namespace rigproof::ml
