// The corners of one view: predicted minus measured pixels.
#include <cmath>

#include "../board_in_camera.h"
#include "../corner_model.h"

namespace rigproof::ml {
namespace {

// Cost of a corner that a trial state puts behind the camera: as bad as a very wrong one, without a slope.
constexpr double kBehindCameraSquare = 1e8;

// Sum of the loss of many residuals: one logarithm of their product, kept as what it exceeds one by.
class CostSum {
 public:
  explicit CostSum(double c2) : c2_(c2) {}
  void add(double square) {
    constexpr double kLargest = 1e200;
    const double x = square / c2_;
    excess_ += x + excess_ * x;
    if (excess_ < kLargest) return;
    sum_ += std::log1p(excess_);
    excess_ = 0.0;
  }
  double cost() const { return c2_ * (sum_ + std::log1p(excess_)); }

 private:
  double c2_, excess_ = 0.0, sum_ = 0.0;
};

// Unknowns that corners know directly: their first columns, -1 where they are believed.
struct Direct {
  Direct(const Evaluation& at, int camera, TwistSystem* system)
      : lens(system->append(at.layout, Nuisance::kLens, camera)),
        shape(system->append(at.layout, Nuisance::kBoardShape, 0)),
        readout(system->append(at.layout, Nuisance::kReadout, camera)) {}
  int lens, shape, readout;
};

// The displacement of a view, a group beside its corners: levels and the budget of the uncertainty count it apart.
void take_displacement(const Evaluation& at, const BoardInCamera& seen, TwistSystem* of_corners, LocalBlock* block,
                       BlockSink* sink) {
  constexpr double kParts = DisplacementRows::kParts;
  const DisplacementRows rows = of_corners->displacement(seen.motion);
  const double square = rows.residual.squaredNorm();
  TwistSystem system;
  Direct(at, block->camera, &system);
  system.add(rows, 1.0);
  of_corners->eliminate_error(seen.motion);
  of_corners->add(rows, -1.0);
  LocalBlock displaced(Group::kDisplacement, 0);
  displaced.sum.add(square, 1.0, kParts);
  displaced.sum.leverage = rows.unknown;
  displaced.cost = square;
  block->cost -= square;
  block->sum.add(-square, 1.0, 0.0);
  block->sum.leverage = kParts - rows.unknown;
  system.chain(seen, &displaced);
  sink->add(displaced);
}

}  // namespace

void corners(const Evaluation& at, const WhitenedView& view, BlockSink* sink) {
  const Camera camera = lens_at(at, view.camera);
  const double whiten = 1.0 / at.noise.corner_scale[static_cast<std::size_t>(view.camera)];
  const LensChange lens_change = at.state.nuisances.of(Nuisance::kLens, view.camera);
  const double coefficient_by_px = at.lenses[static_cast<std::size_t>(view.camera)].coefficient_by_px();
  const Eigen::Vector4d board_shape = at.state.nuisances.of(Nuisance::kBoardShape);
  const BoardInCamera seen = board_in_view(at, view);
  const bool moves = seen.motion.moves();
  const Eigen::Matrix3d R_camera_board = seen.T_camera_board.rotation_matrix();
  LocalBlock block(Group::kCorners, view.camera);
  TwistSystem system;
  const auto [lens, shape, readout] = Direct(at, view.camera, &system);
  RowJacobian<2, TwistSystem::kMaxDirect> direct = RowJacobian<2, TwistSystem::kMaxDirect>::Zero();
  CostSum cost(at.loss.c2);
  for (const WhitenedView::Corner& corner : view.corners) {
    const CornerOfBoard on_board = shape >= 0 ? corner_of_board(at.observations.board, board_shape, corner.point_board)
                                              : CornerOfBoard{corner.point_board, {}};
    const Eigen::Vector3d q = R_camera_board * on_board.point + seen.T_camera_board.translation;
    RowResidual residual;
    if (!row_residual(camera, seen.motion, q, corner.pixel, &residual)) {
      block.sum.dimensions += 2;
      cost.add(kBehindCameraSquare);
      continue;
    }
    const Eigen::Matrix2d W = whiten * corner.whitening;
    const Eigen::Vector2d r = W * residual.value;
    const double s = r.squaredNorm(), w = at.loss.weight(s);
    cost.add(s);
    block.sum.add(s, w, 2);
    const RowJacobian<2, 6> J = W * residual.by_twist;
    if (lens >= 0)
      direct.middleCols<5>(lens) = W * pixel_by_lens(camera, lens_change, coefficient_by_px, residual.point_camera,
                                                     residual.value + corner.pixel);
    if (shape >= 0) direct.middleCols<4>(shape) = W * (residual.by_point * R_camera_board) * on_board.by_shape;
    if (readout >= 0) direct.col(readout) = W * residual.by_readout;
    const double factor = block_factor(at.weighting, w, 2);
    if (moves)
      system.add<2>(J, W * residual.by_motion, direct, r, factor);
    else
      system.add<2>(J, direct, r, factor);
  }
  block.cost = cost.cost() + seen.motion.error.squaredNorm();
  block.sum.add(seen.motion.error.squaredNorm(), 1.0, 0.0);
  if (moves && at.weighting == Weighting::kInformation)
    take_displacement(at, seen, &system, &block, sink);
  else if (moves)
    system.eliminate_error(seen.motion);
  system.chain(seen, &block);
  sink->add(block);
}

ViewFit view_fit(const Evaluation& at, const WhitenedView& view) {
  ViewFit fit;
  if (view.corners.empty()) return fit;
  const Camera camera = lens_at(at, view.camera);
  const double scale = at.noise.corner_scale[static_cast<std::size_t>(view.camera)];
  const BoardInCamera seen = board_in_view(at, view);
  const Eigen::Vector4d shape = at.state.nuisances.of(Nuisance::kBoardShape);
  double square = 0.0, weight = 0.0;
  for (const WhitenedView::Corner& corner : view.corners) {
    RowResidual residual;
    const Eigen::Vector3d on_board = corner_of_board(at.observations.board, shape, corner.point_board).point;
    if (!row_residual(camera, seen.motion, seen.T_camera_board * on_board, corner.pixel, &residual)) continue;
    square += residual.value.squaredNorm();
    weight += at.loss.weight((corner.whitening * residual.value / scale).squaredNorm());
  }
  const double count = static_cast<double>(view.corners.size());
  return {std::sqrt(square / count), weight / count};
}

}  // namespace rigproof::ml
