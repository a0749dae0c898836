#include "repeating_couplings.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
        by_motion(Eigen::MatrixXd::Zero(2 * corners, 0)),
        roots(static_cast<std::size_t>(corners), Eigen::Matrix2d::Zero()) {}
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_globals, by_offset, by_field;
  Eigen::MatrixXd by_motion, motion_covariance;  // of the motion's error; only where it moves
  Eigen::MatrixXd field_of_rest;                 // by_field without what the error of the motion explains
  std::vector<Eigen::Matrix2d> roots;            // whitening, weighted

  // What the error of the motion explains tells nothing. Of the corners' own offsets that is too little to count.
  void take_out(const RowMotion& motion) {
    if (!motion.moves()) return;
    by_motion = by_globals.rightCols<kMotion>();
    motion_covariance = motion.covariance(by_motion.transpose() * by_motion);
    const Eigen::MatrixXd by_error = motion_covariance * by_motion.transpose();
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

namespace {

// Errors of corners enter with the poses and the globals that their view depends on.
// @param place of the first error @param by_globals by the view's twist, its lens, the board's shape and its motion
void couple(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, int place,
            const Eigen::MatrixXd& by_globals, PoseRows* with_poses, Eigen::MatrixXd* with_globals) {
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
    if (segment.pose < 0)
      add_to(with_globals->block(segment.offset, place, segment.size, size));
    else
      add_to(with_poses->block(6 * segment.pose + segment.offset, place, segment.size, size));
  }
  if (at.layout.has(Nuisance::kLens))
    with_globals->block(at.layout.place(Nuisance::kLens, view.camera), place, kLens, size) +=
        by_globals.middleRows<kLens>(kTwist);
  if (at.layout.has(Nuisance::kBoardShape))
    with_globals->block(at.layout.place(Nuisance::kBoardShape, view.board), place, kShape, size) +=
        by_globals.middleRows<kShape>(kTwist + kLens);
  if (at.layout.has(Nuisance::kReadout) && seen.motion.moves())
    with_globals->row(at.layout.place(Nuisance::kReadout, view.camera)).segment(place, size) +=
        by_globals.row(kWithoutMotion);
}

}  // namespace

RepeatingCouplings::RepeatingCouplings(const RemovedErrors& removed, int poses, int globals)
    : removed_(removed),
      errors_(removed.errors),
      raw_with_poses_(PoseRows::Zero(6 * poses, errors_.raw_size())),
      raw_with_globals_(Eigen::MatrixXd::Zero(globals, errors_.raw_size())),
      own_(Eigen::MatrixXd::Zero(errors_.raw_size(), errors_.raw_size())),
      gradient_(Eigen::VectorXd::Zero(errors_.raw_size())) {
  Eigen::Index rows = 0;
  for (const Eigen::MatrixXd& field : removed.fields) rows += field.rows();
  const std::size_t corners = static_cast<std::size_t>(rows) / (2 * std::max<std::size_t>(1, removed.fine.size()));
  for (const RemovedErrors::Fine& fine : removed.fine) {
    fine_.emplace_back();
    if (fine.numbers)
      fine_.back().emplace(Fine{fine.numbers.get(), FineSquares(*fine.numbers, corners),
                                FieldEquations(poses, globals, fine.numbers->size()),
                                Eigen::MatrixXd::Zero(errors_.raw_size(), fine.numbers->size())});
  }
}

void RepeatingCouplings::add(const Evaluation& at, std::size_t index, const WhitenedView& view) {
  const BoardInCamera seen = board_in_view(at, view);
  const Rows rows = rows_of(at, view, seen, index);
  const int field = errors_.field(view.camera);
  const Eigen::Index fields = field >= 0 ? rows.by_field.cols() : 0;
  if (fields > 0) {
    couple(at, view, seen, field, rows.by_globals.transpose() * rows.by_field, &raw_with_poses_, &raw_with_globals_);
    own_.block(field, field, fields, fields).noalias() += rows.by_field.transpose() * rows.field_left();
    gradient_.segment(field, fields).noalias() += rows.by_field.transpose() * rows.residual;
  }
  if (errors_.print(view.board, 0) >= 0) add_print(at, view, seen, rows);
  if (const auto camera = static_cast<std::size_t>(view.camera); camera < fine_.size())
    if (fine_[camera]) add_fine(at, view, seen, rows, &*fine_[camera]);
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
  couple(at, view, seen, first, by_globals, &raw_with_poses_, &raw_with_globals_);
}

// Summed over the corners first, a view is added once.
void RepeatingCouplings::add_fine(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen,
                                  const Rows& rows, Fine* fine) const {
  const FineNumbers& numbers = *fine->numbers;
  const int field = errors_.field(view.camera);
  Eigen::MatrixXd whitened(rows.residual.size(), numbers.size());
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::Matrix2d& root = rows.roots[i];
    const Eigen::VectorXd by_number = numbers.at(view.corners[i].pixel);
    whitened.middleRows<2>(row) = FineNumbers::rows(root, by_number);
    fine->squares.add(view.corners[i].pixel, by_number, root.transpose() * root);
    if (const int print = errors_.print(view.board, view.corners[i].id); print >= 0)
      fine->with_raw.middleRows<3>(print).noalias() +=
          rows.by_offset.middleRows<2>(row).transpose() * whitened.middleRows<2>(row);
  }
  FieldEquations& equations = fine->equations;
  equations.gradient.noalias() += whitened.transpose() * rows.residual;
  if (field >= 0)
    fine->with_raw.middleRows(field, rows.by_field.cols()).noalias() += rows.field_left().transpose() * whitened;
  if (rows.by_motion.cols() > 0) {
    const Eigen::MatrixXd by_motion = rows.by_motion.transpose() * whitened;
    equations.own.noalias() -= by_motion.transpose() * rows.motion_covariance * by_motion;
  }
  couple(at, view, seen, 0, rows.by_globals.transpose() * whitened, &equations.with_poses, &equations.with_globals);
}

void RepeatingCouplings::add_to(ArrowSystem* system) {
  const Eigen::MatrixXd& M = errors_.raw_by_unknowns();
  const Eigen::Index first = raw_with_globals_.rows(), size = M.cols();
  system->pose_global.rightCols(size) = raw_with_poses_ * M;
  system->global.topRightCorner(first, size) = raw_with_globals_ * M;
  system->global.bottomLeftCorner(size, first) = system->global.topRightCorner(first, size).transpose();
  // Offsets come first: between them and fields only one of the two blocks was filled.
  const Eigen::MatrixXd own = own_.selfadjointView<Eigen::Upper>();
  system->global.bottomRightCorner(size, size) = M.transpose() * own * M;
  system->global.diagonal().tail(size).array() += 1.0;
  system->global_gradient.tail(size) = M.transpose() * gradient_ + removed_.value;
  for (std::size_t c = 0; c < fine_.size(); ++c) {
    if (!fine_[c]) continue;
    FieldEquations& field = system->fields.emplace_back(std::move(fine_[c]->equations));
    field.own += fine_[c]->squares.sum();
    field.with_globals.conservativeResize(first + size, Eigen::NoChange);
    field.with_globals.bottomRows(size) = errors_.by_unknowns(fine_[c]->with_raw);
    field.gradient += removed_.fine[c].value;
  }
}

}  // namespace rigproof::ml
