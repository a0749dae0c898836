#include "repeating_couplings.h"

#include <algorithm>
#include <cmath>

#include "corner_model.h"

namespace rigproof::ml {
namespace {

constexpr int kTwist = 6, kLens = 5, kShape = 4, kReadout = 1;
constexpr int kWithoutMotion = kTwist + kLens + kShape;

}  // namespace

// The corners of a view, whitened and weighted: residual, and derivatives by the view's twist, the lens and the board's
// shape, and where it moves while rows are read by readout and motion; by each corner's own offset; and by the field. A
// corner that is not in front of the camera has none.
struct RepeatingCouplings::Rows {
  Rows(Eigen::Index corners, Eigen::Index fields, bool moves)
      : residual(Eigen::VectorXd::Zero(2 * corners)),
        by_globals(Eigen::MatrixXd::Zero(2 * corners, kWithoutMotion + (moves ? kReadout + kMotion : 0))),
        by_offset(Eigen::MatrixXd::Zero(2 * corners, 3)),
        by_field(Eigen::MatrixXd::Zero(2 * corners, fields)),
        roots(static_cast<std::size_t>(corners), Eigen::Matrix2d::Zero()) {}
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_globals, by_offset, by_field;
  Eigen::MatrixXd field_of_rest;       // by_field without what the error of the motion explains
  std::vector<Eigen::Matrix2d> roots;  // whitening, weighted

  // What the error of the motion explains tells nothing. Of the corners' own offsets that is too little to count.
  void take_out(const RowMotion& motion) {
    if (!motion.moves()) return;
    const Eigen::MatrixXd by_motion = by_globals.rightCols<kMotion>();
    const Eigen::MatrixXd by_error = motion.covariance(by_motion.transpose() * by_motion) * by_motion.transpose();
    field_of_rest = by_field - by_motion * (by_error * by_field);
    by_globals -= by_motion * (by_error * by_globals);
  }
  const Eigen::MatrixXd& field_left() const { return field_of_rest.size() > 0 ? field_of_rest : by_field; }
};

RepeatingCouplings::Rows RepeatingCouplings::rows_of(const Evaluation& at, const WhitenedView& view,
                                                     const BoardInCamera& seen, std::size_t index) const {
  const Camera lens = lens_at(at, view.camera);
  const LensChange change = at.state.nuisances.of(Nuisance::kLens, view.camera);
  const double by_px = at.lenses[static_cast<std::size_t>(view.camera)].coefficient_by_px();
  const double whiten = 1.0 / at.noise.corner_scale[static_cast<std::size_t>(view.camera)];
  const Eigen::Matrix3d R = seen.T_camera_board.rotation_matrix();
  const Eigen::Vector4d shape = at.state.nuisances.of(Nuisance::kBoardShape, view.board);
  const Eigen::MatrixXd& fields = removed_.fields[index];
  // Corners without a finite covariance are missing among those that are whitened.
  const bool all_there = fields.rows() == 2 * static_cast<Eigen::Index>(view.corners.size());
  Rows rows(static_cast<Eigen::Index>(view.corners.size()), fields.cols(), seen.motion.moves());
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const WhitenedView::Corner& corner = view.corners[i];
    const CornerOfBoard on_board = corner_of_board(at.observations.board_at(view.board), shape, corner.point_board);
    const Eigen::Vector3d q = R * on_board.point + seen.T_camera_board.translation;
    RowResidual residual;
    if (!row_residual(lens, seen.motion, q, corner.pixel, &residual)) continue;
    const Eigen::Matrix2d W = whiten * corner.whitening;
    const double weight = at.loss.weight((W * residual.value).squaredNorm());
    const Eigen::Matrix2d& root = rows.roots[i] = std::sqrt(block_factor(at.weighting, weight, 2)) * W;
    const Eigen::Matrix<double, 2, 3> by_offset = residual.by_point * R;
    const auto row = static_cast<Eigen::Index>(2 * i);
    rows.residual.segment<2>(row) = root * residual.value;
    auto by_globals = rows.by_globals.middleRows<2>(row);
    by_globals.leftCols<kTwist>() = root * residual.by_twist;
    by_globals.middleCols<kLens>(kTwist) =
        root * pixel_by_lens(lens, change, by_px, residual.point_camera, residual.value + corner.pixel);
    by_globals.middleCols<kShape>(kTwist + kLens) = root * by_offset * on_board.by_shape;
    if (seen.motion.moves()) by_globals.col(kWithoutMotion) = root * residual.by_readout;
    if (seen.motion.moves()) by_globals.rightCols<kMotion>() = root * residual.by_motion;
    rows.by_offset.middleRows<2>(row) = root * by_offset;
    if (fields.cols() == 0) continue;
    if (all_there)
      rows.by_field.middleRows<2>(row).noalias() = root * fields.middleRows<2>(row);
    else
      rows.by_field.middleRows<2>(row) = root * errors_.lens_field(view.camera).at(corner.pixel);
  }
  rows.take_out(seen.motion);
  return rows;
}

void Couplings::add(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, int place,
                    const Eigen::MatrixXd& by_globals) {
  const auto size = static_cast<int>(by_globals.cols());
  const auto by_twist = by_globals.topRows<kTwist>();
  for (std::size_t p = 0; p < static_cast<std::size_t>(seen.count); ++p) {
    const BoardInCamera::Part& part = seen.parts[p];
    const Segment& segment = part.segment;
    const auto add_to = [&](auto coupling) {
      coupling.noalias() += part.twist.leftCols(segment.size).transpose() * by_twist;
      if (seen.motion.moves())
        coupling.noalias() += part.motion.leftCols(segment.size).transpose() * by_globals.bottomRows<kMotion>();
    };
    if (segment.pose < 0) {
      add_to(with_globals.block(segment.offset, place, segment.size, size));
    } else {
      add_to(with_poses.block(6 * segment.pose + segment.offset, place, segment.size, size));
      add_range(segment.pose, {place, place + size});
    }
  }
  if (at.layout.has(Nuisance::kLens))
    with_globals.block(at.layout.place(Nuisance::kLens, view.camera), place, kLens, size) +=
        by_globals.middleRows<kLens>(kTwist);
  if (at.layout.has(Nuisance::kBoardShape))
    with_globals.block(at.layout.place(Nuisance::kBoardShape, view.board), place, kShape, size) +=
        by_globals.middleRows<kShape>(kTwist + kLens);
  if (at.layout.has(Nuisance::kReadout) && seen.motion.moves())
    with_globals.row(at.layout.place(Nuisance::kReadout, view.camera)).segment(place, size) +=
        by_globals.row(kWithoutMotion);
}

void Couplings::add_range(int pose, Range range) {
  std::vector<Range>& ranges = of_pose[static_cast<std::size_t>(pose)];
  for (std::size_t i = ranges.size(); i-- > 0;) {
    const Range& other = ranges[i];
    if (other.end < range.first || other.first > range.end) continue;
    range = {std::min(range.first, other.first), std::max(range.end, other.end)};
    ranges.erase(ranges.begin() + static_cast<std::ptrdiff_t>(i));
  }
  ranges.push_back(range);
}

RepeatingCouplings::RepeatingCouplings(const RemovedErrors& removed, int poses, int globals, bool with_fine)
    : removed_(removed),
      errors_(removed.errors),
      raw_(poses, globals, errors_.raw_size()),
      own_(Eigen::MatrixXd::Zero(errors_.raw_size(), errors_.raw_size())),
      gradient_(Eigen::VectorXd::Zero(errors_.raw_size())),
      fine_(0, 0, 0) {
  int size = 0;
  for (std::size_t c = 0; with_fine && c < removed.fine.size(); ++c) {
    std::vector<GridColumns>& grids = fine_grids_.emplace_back();
    for (const RemovedErrors::Fine::Grid& grid : removed.fine[c].grids) {
      grids.push_back(
          {FineField(errors_.lens_field(static_cast<int>(c)).camera(), grid.cells), size, grid.counted_px()});
      size += grids.back().field.size();
    }
  }
  fine_ = Couplings(poses, globals, size);
  raw_with_fine_ = Eigen::MatrixXd::Zero(errors_.raw_size(), size);
}

void RepeatingCouplings::add(const Evaluation& at, std::size_t index, const WhitenedView& view) {
  const BoardInCamera seen = board_in_view(at, view);
  const Rows rows = rows_of(at, view, seen, index);
  const int field = errors_.field(view.camera);
  const Eigen::Index fields = field >= 0 ? rows.by_field.cols() : 0;
  if (fields > 0) {
    raw_.add(at, view, seen, field, rows.by_globals.transpose() * rows.by_field);
    own_.block(field, field, fields, fields).noalias() += rows.by_field.transpose() * rows.field_left();
    gradient_.segment(field, fields).noalias() += rows.by_field.transpose() * rows.residual;
  }
  if (errors_.print(view.board, 0) >= 0) add_print(at, view, seen, rows);
  if (!fine_grids_.empty())
    for (const GridColumns& grid : fine_grids_[static_cast<std::size_t>(view.camera)])
      add_fine(at, view, seen, rows, grid);
}

// Offsets of all corners lie one after the other: a view is added once.
void RepeatingCouplings::add_print(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen,
                                   const Rows& rows) {
  const int field = errors_.field(view.camera), first = errors_.print(view.board, 0);
  const int prints = 3 * at.observations.board_at(view.board).corner_count();
  Eigen::MatrixXd by_globals = Eigen::MatrixXd::Zero(rows.by_globals.cols(), prints);
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const int print = errors_.print(view.board, view.corners[i].id);
    const Eigen::Matrix<double, 2, 3> by_offset = rows.by_offset.middleRows<2>(row);
    by_globals.middleCols<3>(print - first).noalias() += rows.by_globals.middleRows<2>(row).transpose() * by_offset;
    own_.block<3, 3>(print, print) += by_offset.transpose() * by_offset;
    gradient_.segment<3>(print) += by_offset.transpose() * rows.residual.segment<2>(row);
    if (field >= 0)
      own_.block(print, field, 3, rows.by_field.cols()) +=
          by_offset.transpose().lazyProduct(rows.field_left().middleRows<2>(row));
  }
  raw_.add(at, view, seen, first, by_globals);
}

// Corners share nodes: summed over the corners first, a view is added once.
void RepeatingCouplings::add_fine(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen,
                                  const Rows& rows, const GridColumns& grid) {
  const int field = errors_.field(view.camera);
  Eigen::MatrixXd by_globals = Eigen::MatrixXd::Zero(rows.by_globals.cols(), grid.field.size());
  int first = grid.field.nodes(), last = -1;
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const int print = errors_.print(view.board, view.corners[i].id);
    const Eigen::Matrix2d by_pixel = grid.sigma_px * rows.roots[i];
    const Eigen::MatrixX2d globals_by_pixel = rows.by_globals.middleRows<2>(row).transpose().lazyProduct(by_pixel);
    const Eigen::Matrix<double, 3, 2> offset_by_pixel = rows.by_offset.middleRows<2>(row).transpose() * by_pixel;
    const Eigen::MatrixX2d field_by_pixel = rows.field_left().middleRows<2>(row).transpose().lazyProduct(by_pixel);
    for (const FineField::Share& share : grid.field.at(view.corners[i].pixel)) {
      const int place = grid.first + 2 * share.node;
      by_globals.middleCols<2>(2 * share.node) += share.weight * globals_by_pixel;
      if (print >= 0) raw_with_fine_.block<3, 2>(print, place) += share.weight * offset_by_pixel;
      if (field >= 0) raw_with_fine_.block(field, place, field_by_pixel.rows(), 2) += share.weight * field_by_pixel;
      first = std::min(first, share.node);
      last = std::max(last, share.node);
    }
  }
  if (last >= first)
    fine_.add(at, view, seen, grid.first + 2 * first, by_globals.middleCols(2 * first, 2 * (last - first + 1)));
}

void RepeatingCouplings::add_to(ArrowSystem* system) const {
  const Eigen::MatrixXd& M = errors_.raw_by_unknowns();
  const Eigen::Index first = raw_.with_globals.rows(), size = M.cols();
  system->pose_global.rightCols(size) = raw_.with_poses * M;
  system->global.topRightCorner(first, size) = raw_.with_globals * M;
  system->global.bottomLeftCorner(size, first) = system->global.topRightCorner(first, size).transpose();
  // Offsets come first: between them and fields only one of the two blocks was filled.
  const Eigen::MatrixXd own = own_.selfadjointView<Eigen::Upper>();
  system->global.bottomRightCorner(size, size) = M.transpose() * own * M;
  system->global.diagonal().tail(size).array() += 1.0;
  system->global_gradient.tail(size) = M.transpose() * gradient_ + removed_.value;
}

Couplings RepeatingCouplings::of_fine_fields() const {
  Couplings all = fine_;
  all.with_globals.conservativeResize(fine_.with_globals.rows() + errors_.size(), Eigen::NoChange);
  all.with_globals.bottomRows(errors_.size()) = errors_.by_unknowns(raw_with_fine_);
  return all;
}

}  // namespace rigproof::ml
