#include "rigproof/calib/estimate/repeating_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "corner_model.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/whitened.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

constexpr std::size_t kMostStops = 3000;
// Of the views that tell the errors: evenly chosen, since more tell little more.
constexpr std::size_t kMostViews = 240;
constexpr int kLens = 5, kShape = 4;

// What the offsets of a board's corners may not hold since other unknowns have it: translation, rotation, the side of
// the squares along x and y, the bow along x and y. 3 corners x 10, orthonormal.
Eigen::MatrixXd shape_modes(const Board& board) {
  const int corners = board.corner_count();
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * corners, 10);
  for (int id = 0; id < corners; ++id) {
    const Eigen::Vector3d p = (board.corner(id) - board.centre()) / board.square_m;
    auto of_corner = modes.middleRows<3>(3 * id);
    of_corner.row(0).head<4>() << 1.0, 0.0, -p.y(), p.x();
    of_corner.row(1).head<3>() << 0.0, 1.0, p.x();
    of_corner(1, 4) = p.y();
    of_corner.row(2).tail<5>() << 1.0, p.x(), p.y(), p.x() * p.x(), p.y() * p.y();
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(modes);
  return qr.householderQ() * Eigen::MatrixXd::Identity(3 * corners, 3 * corners);
}

// Rows of a view's corners, whitened by what is stated: residual, and derivatives by the view's pose (chart of
// transform_error()) and by what it knows of the others: lens, shape, offset of each corner, field.
struct ViewRows {
  int camera;
  std::vector<int> raw;  // of each column after lens and shape: its place among the raw errors
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_pose, by_others;
};

class ViewReader {
 public:
  ViewReader(const RemovedErrors& removed, const Observations& observations)
      : errors_(removed.errors), fields_(removed.fields), seen_(observations) {
    for (const RigCamera& camera : observations.cameras) lenses_.emplace_back(camera.camera);
  }

  ViewRows rows_of(const ViewPose& pose) const {
    const BoardView& view = seen_.board_views[static_cast<std::size_t>(pose.view)];
    const std::vector<WhitenedView::Corner> corners = whitened_corners(view, seen_.board);
    const auto rows = static_cast<Eigen::Index>(2 * corners.size());
    ViewRows result{view.camera, raw_columns(view), Eigen::VectorXd::Zero(rows), Eigen::MatrixXd::Zero(rows, 6), {}};
    result.by_others.setZero(rows, kLens + kShape + static_cast<Eigen::Index>(result.raw.size()));
    for (std::size_t i = 0; i < corners.size(); ++i) add(pose, corners[i], view.camera, i, &result);
    return result;
  }

 private:
  std::vector<int> raw_columns(const BoardView& view) const {
    std::vector<int> raw;
    for (const CornerObservation& corner : view.corners)
      for (int axis = 0; errors_.print(corner.id) >= 0 && axis < 3; ++axis)
        raw.push_back(errors_.print(corner.id) + axis);
    for (int i = 0; errors_.field(view.camera) >= 0 && i < errors_.lens_field(view.camera).size(); ++i)
      raw.push_back(errors_.field(view.camera) + i);
    return raw;
  }

  void add(const ViewPose& pose, const WhitenedView::Corner& corner, int camera, std::size_t index,
           ViewRows* rows) const {
    const Rigid3& T = pose.T_camera_board;
    const std::size_t c = static_cast<std::size_t>(camera);
    const Camera& lens = seen_.cameras[c].camera;
    const Eigen::Vector3d turned = T.rotation * corner.point_board, q = turned + T.translation;
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> by_point;
    if (!corner.whitening.allFinite() || !lens.project(q, &pixel, &by_point)) return;
    const Eigen::Matrix2d& W = corner.whitening;
    const auto at = static_cast<Eigen::Index>(2 * index);
    const Eigen::Matrix<double, 2, 3> by_offset = W * by_point * T.rotation_matrix();
    rows->residual.segment<2>(at) = W * (pixel - corner.pixel);
    rows->by_pose.block<2, 3>(at, 0) = W * by_point;
    rows->by_pose.block<2, 3>(at, 3) = -W * by_point * skew(turned);
    auto others = rows->by_others.middleRows<2>(at);
    others.leftCols<kLens>() = W * pixel_by_lens(lens, LensChange::Zero(), lenses_[c].coefficient_by_px(), q, pixel);
    others.middleCols<kShape>(kLens) =
        by_offset * corner_of_board(seen_.board, Eigen::Vector4d::Zero(), corner.point_board).by_shape;
    const Eigen::Index fields = errors_.field(camera) >= 0 ? errors_.lens_field(camera).size() : 0;
    if (errors_.print(0) >= 0) others.middleCols<3>(kLens + kShape + 3 * static_cast<Eigen::Index>(index)) = by_offset;
    if (fields > 0) others.rightCols(fields) = W * fields_[static_cast<std::size_t>(pose.view)].middleRows<2>(at);
  }

  const RepeatingErrors& errors_;
  const std::vector<Eigen::MatrixXd>& fields_;
  const Observations& seen_;
  std::vector<Lenses> lenses_;
};

// The unknowns: five of each lens, four of the board, the repeating errors. Poses of views are eliminated.
class ImagesAlone {
 public:
  ImagesAlone(const RepeatingErrors& errors, std::size_t cameras, const Priors& priors)
      : errors_(errors), cameras_(static_cast<int>(cameras)) {
    const Eigen::Index lenses = kLens * cameras_;
    prior_ = Eigen::VectorXd::Ones(lenses + kShape + errors.size());
    constexpr double kBelieved = 1e12;  // information, where nothing is left open
    const auto information = [](double variance) { return variance > 0.0 ? 1.0 / variance : kBelieved; };
    for (int c = 0; c < cameras_; ++c)
      for (int i = 0; i < kLens; ++i) prior_[kLens * c + i] = information(priors.covariance(Nuisance::kLens, c)(i, i));
    for (int i = 0; i < kShape; ++i) prior_[lenses + i] = information(priors.covariance(Nuisance::kBoardShape)(i, i));
  }

  // The next estimate, and its residuals; weights of corners by how they fit.
  Eigen::VectorXd solve(std::vector<ViewRows>* views, std::vector<Eigen::VectorXd>* residuals) const {
    const int raw = kLens * cameras_ + kShape + errors_.raw_size();
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(raw, raw);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(raw);
    const std::vector<double> levels = squares_of_levels(*views, *residuals);
    std::vector<Eigen::MatrixXd> to_pose;
    for (std::size_t v = 0; v < views->size(); ++v)
      to_pose.push_back(
          add((*views)[v], (*residuals)[v], levels[static_cast<std::size_t>((*views)[v].camera)], &N, &g));
    const Eigen::MatrixXd M = raw_by_unknowns();
    Eigen::MatrixXd H = M.transpose() * N.selfadjointView<Eigen::Lower>() * M;
    H.diagonal() += prior_;
    const Eigen::LLT<Eigen::MatrixXd> llt(H);
    const Eigen::VectorXd z = -llt.solve(M.transpose() * g), of_raw = M * z;
    for (std::size_t v = 0; v < views->size(); ++v) (*residuals)[v] = left_over((*views)[v], to_pose[v], of_raw);
    return z.tail(errors_.size());
  }

 private:
  Eigen::MatrixXd raw_by_unknowns() const {
    const Eigen::Index first = kLens * cameras_ + kShape;
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(first + errors_.raw_size(), first + errors_.size());
    M.topLeftCorner(first, first).setIdentity();
    M.bottomRightCorner(errors_.raw_size(), errors_.size()) = errors_.raw_by_unknowns();
    return M;
  }

  // Of each camera: what its corners scatter by, as a multiple of what is stated.
  std::vector<double> squares_of_levels(const std::vector<ViewRows>& views,
                                        const std::vector<Eigen::VectorXd>& residuals) const {
    constexpr double kMedianSquare = 1.386;  // of a whitened residual of two dimensions: 2 ln 2
    std::vector<std::vector<double>> squares(static_cast<std::size_t>(cameras_));
    for (std::size_t v = 0; v < views.size(); ++v)
      for (Eigen::Index i = 0; i + 1 < residuals[v].size(); i += 2)
        squares[static_cast<std::size_t>(views[v].camera)].push_back(residuals[v].segment<2>(i).squaredNorm());
    std::vector<double> levels;
    for (std::vector<double>& of_camera : squares)
      levels.push_back(of_camera.empty() ? 1.0 : std::max(1e-4, median(std::move(of_camera)) / kMedianSquare));
    return levels;
  }

  int place(const ViewRows& view, Eigen::Index column) const {
    if (column < kLens) return kLens * view.camera + static_cast<int>(column);
    const int lenses = kLens * cameras_;
    if (column < kLens + kShape) return lenses + static_cast<int>(column) - kLens;
    return lenses + kShape + view.raw[static_cast<std::size_t>(column - kLens - kShape)];
  }

  // Adds a view without its pose. Returns what makes the pose's step of the others' and of the residual.
  Eigen::MatrixXd add(const ViewRows& view, const Eigen::VectorXd& fits, double level, Eigen::MatrixXd* N,
                      Eigen::VectorXd* g) const {
    Eigen::VectorXd weights(view.residual.size());
    for (Eigen::Index i = 0; i < weights.size(); i += 2)
      weights.segment<2>(i).setConstant(CauchyLoss().weight(fits.segment<2>(i).squaredNorm() / level) / level);
    const Eigen::MatrixXd weighted_pose = view.by_pose.transpose() * weights.asDiagonal();
    const Eigen::MatrixXd to_pose = -(weighted_pose * view.by_pose).ldlt().solve(weighted_pose);  // 6 x rows
    const Eigen::MatrixXd free = view.by_others + view.by_pose * (to_pose * view.by_others);
    const Eigen::MatrixXd H = view.by_others.transpose() * weights.asDiagonal() * free;
    const Eigen::VectorXd gradient = free.transpose() * weights.asDiagonal() * view.residual;
    for (Eigen::Index j = 0; j < H.cols(); ++j) {
      const int column = place(view, j);
      (*g)[column] += gradient[j];
      for (Eigen::Index i = 0; i < H.rows(); ++i) {
        const int row = place(view, i);
        if (row >= column) (*N)(row, column) += H(i, j);
      }
    }
    return to_pose;
  }

  Eigen::VectorXd left_over(const ViewRows& view, const Eigen::MatrixXd& to_pose, const Eigen::VectorXd& raw) const {
    Eigen::VectorXd others(view.by_others.cols());
    for (Eigen::Index j = 0; j < others.size(); ++j) others[j] = raw[place(view, j)];
    const Eigen::VectorXd moved = view.residual + view.by_others * others;
    return moved + view.by_pose * (to_pose * moved);
  }

  const RepeatingErrors& errors_;
  int cameras_;
  Eigen::VectorXd prior_;  // information
};

}  // namespace

RepeatingErrors::RepeatingErrors(const Observations& observations, const PriorSigmas& priors) {
  fields_.assign(observations.cameras.size(), -1);
  if (priors.believe_told || observations.stops.size() > kMostStops) return;
  const Board& board = observations.board;
  const int corners = 3 * board.corner_count();
  has_print_ = board.print_sigma() > 0.0 && corners > 10;
  int raw = has_print_ ? corners : 0, unknowns = has_print_ ? corners - 10 : 0;
  for (std::size_t c = 0; c < fields_.size(); ++c) {
    lens_fields_.emplace_back(observations.cameras[c].camera);
    if (!(observations.cameras[c].intrinsics_sigma.residual_px > 0.0)) continue;
    fields_[c] = raw;
    raw += lens_fields_[c].size();
    unknowns += lens_fields_[c].size();
  }
  raw_by_unknowns_ = Eigen::MatrixXd::Zero(raw, unknowns);
  if (has_print_)
    raw_by_unknowns_.topLeftCorner(corners, corners - 10) =
        board.print_sigma() * shape_modes(board).rightCols(corners - 10);
  for (std::size_t c = 0, next = has_print_ ? static_cast<std::size_t>(corners) - 10 : 0; c < fields_.size(); ++c) {
    if (fields_[c] < 0) continue;
    const int size = lens_fields_[c].size();
    raw_by_unknowns_.block(fields_[c], static_cast<Eigen::Index>(next), size, size)
        .diagonal()
        .setConstant(observations.cameras[c].intrinsics_sigma.residual_px);
    next += static_cast<std::size_t>(size);
  }
}

RemovedErrors none_removed(const Observations& observations, const PriorSigmas& priors) {
  RemovedErrors removed{RepeatingErrors(observations, priors), {}, {}};
  removed.value = Eigen::VectorXd::Zero(removed.errors.size());
  for (std::size_t v = 0; removed.errors.any() && v < observations.board_views.size(); ++v) {
    const BoardView& view = observations.board_views[v];
    Eigen::MatrixXd& field = removed.fields.emplace_back();
    if (removed.errors.field(view.camera) < 0) continue;
    const LensField& of_lens = removed.errors.lens_field(view.camera);
    field.resize(2 * static_cast<Eigen::Index>(view.corners.size()), of_lens.size());
    for (std::size_t i = 0; i < view.corners.size(); ++i)
      field.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = of_lens.at(view.corners[i].pixel);
  }
  return removed;
}

Eigen::VectorXd estimate_repeating(const RemovedErrors& removed, const Observations& observations,
                                   const std::vector<ViewPose>& views, const Priors& priors) {
  constexpr int kRounds = 3;  // by then weights and levels have settled
  const ViewReader reader(removed, observations);
  const ImagesAlone problem(removed.errors, observations.cameras.size(), priors);
  std::vector<ViewRows> rows;
  const std::size_t step = (views.size() + kMostViews - 1) / kMostViews;
  for (std::size_t v = 0; v < views.size(); v += step) rows.push_back(reader.rows_of(views[v]));
  std::vector<Eigen::VectorXd> residuals;
  for (const ViewRows& view : rows) residuals.push_back(view.residual);
  Eigen::VectorXd estimate;
  for (int round = 0; round < kRounds; ++round) estimate = problem.solve(&rows, &residuals);
  return estimate;
}

RepeatingSize remove_repeating(const RemovedErrors& removed, const std::vector<ViewPose>& views,
                               Observations* observations) {
  const RepeatingErrors& errors = removed.errors;
  const Eigen::VectorXd raw = errors.raw_by_unknowns() * removed.value;
  const std::size_t cameras = observations->cameras.size();
  std::vector<double> squares(cameras, 0.0), counts(cameras, 0.0);
  for (const ViewPose& pose : views) {
    BoardView& view = observations->board_views[static_cast<std::size_t>(pose.view)];
    const std::size_t c = static_cast<std::size_t>(view.camera);
    const Camera& lens = observations->cameras[c].camera;
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      CornerObservation& corner = view.corners[i];
      Eigen::Vector2d pixel, shift = Eigen::Vector2d::Zero();
      Eigen::Matrix<double, 2, 3> by_point;
      const Eigen::Vector3d place = observations->board.corner(corner.id);
      if (const int field = errors.field(view.camera); field >= 0) {
        const Eigen::MatrixXd& by_field = removed.fields[static_cast<std::size_t>(pose.view)];
        shift = by_field.middleRows<2>(2 * static_cast<Eigen::Index>(i)) * raw.segment(field, by_field.cols());
        squares[c] += shift.squaredNorm();
        counts[c] += 2.0;
      }
      if (const int print = errors.print(corner.id);
          print >= 0 && lens.project(pose.T_camera_board * place, &pixel, &by_point))
        shift += by_point * (pose.T_camera_board.rotation * raw.segment<3>(print));
      corner.pixel -= shift;
    }
  }
  RepeatingSize size;
  if (const int print = 3 * observations->board.corner_count(); errors.print(0) >= 0)
    size.print_m = raw.head(print).norm() / std::sqrt(static_cast<double>(print));
  for (std::size_t c = 0; c < cameras; ++c)
    size.field_px.push_back(counts[c] > 0.0 ? std::sqrt(squares[c] / counts[c]) : 0.0);
  return size;
}

}  // namespace rigproof::ml
