// The board's plane in the depth of one view: predicted minus measured inverse-depth plane.
#include "../board_in_camera.h"

namespace rigproof::ml {

void board_plane(const Evaluation& at, const WhitenedPlane& plane, BlockSink* sink) {
  const int c = plane.camera;
  const BoardInCamera seen = board_in_camera(at, plane.stop, c, plane.after_stop_s, plane.board);
  const MeasuredPlane measured = measured_plane(at, plane);
  const BoardPlaneResidual residual = board_plane_residual(seen.T_camera_board, depth_error(at, c), measured.value);
  const Eigen::Matrix3d W = plane.whitening / at.noise.board_plane_scale[static_cast<std::size_t>(c)];
  const Eigen::Vector3d r = W * residual.value;
  const double s = r.squaredNorm(), w = at.loss.weight(s);

  LocalBlock block(Group::kBoardPlane, c);
  TwistSystem system;
  RowJacobian<3, TwistSystem::kMaxDirect> direct = RowJacobian<3, TwistSystem::kMaxDirect>::Zero();
  if (const int own = system.append(at.layout, Nuisance::kDepthScale, c); own >= 0)
    direct.col(own) = W * residual.by_depth_bias;
  const CommonDepth of_make = common_depth(at.observations, c);
  if (const int common = system.append(at.layout, Nuisance::kCommonDepthScale, of_make.camera); common >= 0)
    direct.col(common) = of_make.share * W * residual.by_depth_bias;
  const int lens = system.append(at.layout, Nuisance::kLens, c);
  if (lens >= 0) direct.middleCols<5>(lens) = -W * measured.by_lens;
  const int offset = system.append(at.layout, Nuisance::kDepthOffset, c);
  if (offset >= 0) direct.middleCols<3>(offset) = -W * measured.by_offset;
  const int shape = system.append(at.layout, Nuisance::kDepthShape, c);
  if (shape >= 0) direct.middleCols<6>(shape) = -W * measured.by_shape;
  system.add<3>(W * residual.by_twist, direct, r, block_factor(at.weighting, w, 3));
  block.cost = at.loss.cost(s);
  block.sum.add(s, w, 3);
  system.chain(seen, &block);
  sink->add(block);
}

}  // namespace rigproof::ml
