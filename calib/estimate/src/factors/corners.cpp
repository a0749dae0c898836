// The corners of one view: predicted minus measured pixels.
#include <Eigen/Cholesky>
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
  Direct(const Evaluation& at, int camera, int board, TwistSystem* system)
      : lens(system->append(at.layout, Nuisance::kLens, camera)),
        shape(system->append(at.layout, Nuisance::kBoardShape, board)),
        readout(system->append(at.layout, Nuisance::kReadout, camera)) {}
  int lens, shape, readout;
};

// The displacement of a view, a group beside its corners: levels and the budget of the uncertainty count it apart.
void take_displacement(const Evaluation& at, int board, const BoardInCamera& seen, TwistSystem* of_corners,
                       LocalBlock* block, BlockSink* sink) {
  constexpr double kParts = DisplacementRows::kParts;
  const DisplacementRows rows = of_corners->displacement(seen.motion);
  const double square = rows.residual.squaredNorm();
  TwistSystem system;
  Direct(at, block->camera, board, &system);
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

// Whitened residuals of a view's corners, one after the other, with their derivatives.
class CornerRows {
 public:
  CornerRows(const Evaluation& at, const WhitenedView& view, TwistSystem* system)
      : board_(at.observations.board_at(view.board)),
        camera_(lens_at(at, view.camera)),
        seen_(board_in_view(at, view)),
        lens_change_(at.state.nuisances.of(Nuisance::kLens, view.camera)),
        board_shape_(at.state.nuisances.of(Nuisance::kBoardShape, view.board)),
        coefficient_by_px_(at.lenses[static_cast<std::size_t>(view.camera)].coefficient_by_px()),
        whiten_(1.0 / at.noise.corner_scale[static_cast<std::size_t>(view.camera)]),
        R_camera_board_(seen_.T_camera_board.rotation_matrix()),
        columns_(at, view.camera, view.board, system) {}

  const BoardInCamera& seen() const { return seen_; }
  /// False where the state puts the corner behind the camera.
  bool take(const WhitenedView::Corner& corner) {
    const auto [lens, shape, readout] = columns_;
    const CornerOfBoard on_board =
        shape >= 0 ? corner_of_board(board_, board_shape_, corner.point_board) : CornerOfBoard{corner.point_board, {}};
    const Eigen::Vector3d q = R_camera_board_ * on_board.point + seen_.T_camera_board.translation;
    if (!row_residual(camera_, seen_.motion, q, corner.pixel, &residual_)) return false;
    W_ = whiten_ * corner.whitening;
    r = W_ * residual_.value;
    J = W_ * residual_.by_twist;
    if (lens >= 0)
      direct.middleCols<5>(lens) = W_ * pixel_by_lens(camera_, lens_change_, coefficient_by_px_, residual_.point_camera,
                                                      residual_.value + corner.pixel);
    if (shape >= 0) direct.middleCols<4>(shape) = W_ * (residual_.by_point * R_camera_board_) * on_board.by_shape;
    if (readout >= 0) direct.col(readout) = W_ * residual_.by_readout;
    return true;
  }
  RowJacobian<2, kMotion> by_motion() const { return W_ * residual_.by_motion; }

  Eigen::Vector2d r;
  RowJacobian<2, 6> J;
  RowJacobian<2, TwistSystem::kMaxDirect> direct = RowJacobian<2, TwistSystem::kMaxDirect>::Zero();

 private:
  const Board& board_;
  Camera camera_;
  BoardInCamera seen_;
  LensChange lens_change_;
  Eigen::Vector4d board_shape_;
  double coefficient_by_px_, whiten_;
  Eigen::Matrix3d R_camera_board_;
  Direct columns_;
  RowResidual residual_;
  Eigen::Matrix2d W_;
};

}  // namespace

void corners(const Evaluation& at, const WhitenedView& view, BlockSink* sink) {
  LocalBlock block(Group::kCorners, view.camera);
  TwistSystem system;
  CornerRows rows(at, view, &system);
  const BoardInCamera& seen = rows.seen();
  const bool moves = seen.motion.moves();
  CostSum cost(at.loss.c2);
  for (const WhitenedView::Corner& corner : view.corners) {
    if (!rows.take(corner)) {
      block.sum.dimensions += 2;
      cost.add(kBehindCameraSquare);
      continue;
    }
    const double s = rows.r.squaredNorm(), w = at.loss.weight(s);
    cost.add(s);
    block.sum.add(s, w, 2);
    const double factor = block_factor(at.weighting, w, 2);
    if (moves)
      system.add<2>(rows.J, rows.by_motion(), rows.direct, rows.r, factor);
    else
      system.add<2>(rows.J, rows.direct, rows.r, factor);
  }
  block.cost = cost.cost() + seen.motion.error.squaredNorm();
  block.sum.add(seen.motion.error.squaredNorm(), 1.0, 0.0);
  if (moves && at.weighting == Weighting::kInformation)
    take_displacement(at, view.board, seen, &system, &block, sink);
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
  const Board& board = at.observations.board_at(view.board);
  const Eigen::Vector4d shape = at.state.nuisances.of(Nuisance::kBoardShape, view.board);
  double square = 0.0, weight = 0.0;
  for (const WhitenedView::Corner& corner : view.corners) {
    RowResidual residual;
    const Eigen::Vector3d on_board = corner_of_board(board, shape, corner.point_board).point;
    if (!row_residual(camera, seen.motion, seen.T_camera_board * on_board, corner.pixel, &residual)) continue;
    square += residual.value.squaredNorm();
    weight += at.loss.weight((corner.whitening * residual.value / scale).squaredNorm());
  }
  const double count = static_cast<double>(view.corners.size());
  return {std::sqrt(square / count), weight / count};
}

ViewPull view_pull(const Evaluation& at, const WhitenedView& view, LocalBlock* block) {
  constexpr double kOutlier = 0.2;  // weight of a corner that is six sigmas off
  TwistSystem system;
  CornerRows rows(at, view, &system);
  ViewPull pull;
  RowJacobian<3, 6> by_twist = RowJacobian<3, 6>::Zero();
  RowJacobian<3, TwistSystem::kMaxDirect> by_direct = RowJacobian<3, TwistSystem::kMaxDirect>::Zero();
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (const WhitenedView::Corner& corner : view.corners) {
    if (!rows.take(corner) || at.loss.weight(rows.r.squaredNorm()) < kOutlier) continue;
    const Eigen::Matrix<double, 3, 2> by_turn = rows.J.leftCols<3>().transpose();
    by_twist += by_turn * rows.J;
    by_direct += by_turn * rows.direct;
    slope += by_turn * rows.r;
    ++pull.corners;
  }
  const Eigen::LLT<Eigen::Matrix3d> turning(by_twist.leftCols<3>());
  if (pull.corners == 0 || turning.info() != Eigen::Success) return {};
  turning.matrixL().solveInPlace(by_twist);
  turning.matrixL().solveInPlace(by_direct);
  turning.matrixL().solveInPlace(slope);
  pull.square = slope.squaredNorm();
  system.add<3>(by_twist, by_direct, slope, cauchy_moments(2).efficiency);
  system.chain(rows.seen(), block);
  return pull;
}

}  // namespace rigproof::ml
