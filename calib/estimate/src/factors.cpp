#include "factors.h"

#include "rigproof/calib/estimate/depth_bias.h"

namespace rigproof::ml {
namespace {

// A block without redundancy meets its residual whatever its weight.
Weighting without_redundancy(Weighting weighting) {
  return weighting == Weighting::kSlope ? Weighting::kRobust : weighting;
}

}  // namespace

double block_factor(Weighting weighting, double weight, int dimensions) {
  if (weighting == Weighting::kUnit) return 1.0;
  if (weighting == Weighting::kRobust) return weight;
  const LossMoments& moments = cauchy_moments(dimensions);
  if (weighting == Weighting::kSlope) return weight * moments.weighted_square / moments.weight;
  return weight * moments.efficiency / moments.weight;
}

Camera lens_at(const Evaluation& at, int camera) {
  const std::size_t c = static_cast<std::size_t>(camera);
  if (!at.layout.has(Nuisance::kLens)) return at.observations.cameras[c].camera;
  return at.lenses[c].changed(at.state.nuisances.of(Nuisance::kLens, camera));
}

double depth_error(const Evaluation& at, int camera) {
  const CommonDepth common = common_depth(at.observations, camera);
  return at.state.nuisances.of(Nuisance::kDepthScale, camera)[0] +
         common.share * at.state.nuisances.of(Nuisance::kCommonDepthScale, common.camera)[0];
}

MeasuredPlane measured_plane(const Evaluation& at, const WhitenedPlane& plane) {
  MeasuredPlane result;
  result.value = plane.measured;
  if (at.layout.has(Nuisance::kLens) && plane.registered) {
    result.by_lens = at.lenses[static_cast<std::size_t>(plane.camera)].plane_by(plane.measured);
    result.value += result.by_lens * at.state.nuisances.of(Nuisance::kLens, plane.camera);
  }
  if (at.layout.has(Nuisance::kDepthOffset)) {
    result.by_offset = plane_by_depth_offset(plane.measured, plane.mean_inverse_depth);
    result.value += result.by_offset * at.state.nuisances.of(Nuisance::kDepthOffset, plane.camera);
  }
  if (at.layout.has(Nuisance::kDepthShape)) {
    result.by_shape = plane_by_depth_shape(plane.measured);
    result.value += result.by_shape * at.state.nuisances.of(Nuisance::kDepthShape, plane.camera);
  }
  return result;
}

void add_shared(const Evaluation& at, const std::array<Group, 2>& groups, const Eigen::Matrix3d& share_of_second,
                const Eigen::Vector3d& r, const BlockRows& rows, LocalBlock* block, BlockSink* sink) {
  const double s = r.squaredNorm(), w = at.loss.weight(s);
  const double factor = block_factor(without_redundancy(at.weighting), w, 3);
  for (const bool second : {false, true}) {
    const Eigen::Matrix3d share =
        second ? share_of_second : Eigen::Matrix3d(Eigen::Matrix3d::Identity() - share_of_second);
    block->group = groups[second ? 1 : 0];
    block->cost = second ? 0.0 : at.loss.cost(s);
    block->sum = GroupSum();
    block->sum.add(r.dot(share * r), w, share.trace());
    rows.set_normal(share, r, factor);
    sink->add(*block);
  }
}

}  // namespace rigproof::ml
