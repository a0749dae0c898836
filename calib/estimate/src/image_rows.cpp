#include "image_rows.h"

#include <Eigen/Cholesky>
#include <utility>

#include "corner_model.h"
#include "fine_numbers.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/whitened.h"

namespace rigproof::ml {
namespace {

std::vector<int> raw_columns(const BoardView& view, const RepeatingErrors& errors) {
  std::vector<int> raw;
  for (const CornerObservation& corner : view.corners)
    for (int axis = 0; errors.print(view.board, corner.id) >= 0 && axis < 3; ++axis)
      raw.push_back(errors.print(view.board, corner.id) + axis);
  for (int i = 0; errors.field(view.camera) >= 0 && i < errors.lens_field(view.camera).size(); ++i)
    raw.push_back(errors.field(view.camera) + i);
  return raw;
}

}  // namespace

ViewRows rows_of(const ViewPose& pose, const RemovedErrors& removed, const Observations& observations) {
  const BoardView& view = observations.board_views[static_cast<std::size_t>(pose.view)];
  const RepeatingErrors& errors = removed.errors;
  const Camera& lens = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
  const Board& board = observations.board_of(view);
  const double by_px = coefficient_by_px(lens);
  const std::vector<WhitenedView::Corner> corners = whitened_corners(view, board);
  const auto rows = static_cast<Eigen::Index>(2 * corners.size());
  ViewRows result{view.camera,
                  view.board,
                  raw_columns(view, errors),
                  Eigen::VectorXd::Zero(rows),
                  Eigen::MatrixXd::Zero(rows, 6),
                  {},
                  {},
                  {},
                  {}};
  result.by_others.setZero(rows, kLensColumns + kShapeColumns + static_cast<Eigen::Index>(result.raw.size()));
  const Eigen::Index fields = errors.field(view.camera) >= 0 ? errors.lens_field(view.camera).size() : 0;
  const Eigen::Matrix3d R = pose.T_camera_board.rotation_matrix();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const WhitenedView::Corner& corner = corners[i];
    result.pixels.push_back(corner.pixel);
    result.whitening.emplace_back(Eigen::Matrix2d::Zero());
    const Eigen::Vector3d turned = R * corner.point_board, q = turned + pose.T_camera_board.translation;
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> by_point;
    if (!corner.whitening.allFinite() || !lens.project(q, &pixel, &by_point)) continue;
    result.pixels.back() = pixel;
    const Eigen::Matrix2d& W = result.whitening.back() = corner.whitening;
    const auto at = static_cast<Eigen::Index>(2 * i);
    const Eigen::Matrix<double, 2, 3> by_offset = W * by_point * R;
    result.residual.segment<2>(at) = W * (pixel - corner.pixel);
    result.by_pose.block<2, 3>(at, 0) = W * by_point;
    result.by_pose.block<2, 3>(at, 3) = -W * by_point * skew(turned);
    auto others = result.by_others.middleRows<2>(at);
    others.leftCols<kLensColumns>() = W * pixel_by_lens(lens, LensChange::Zero(), by_px, q, pixel);
    others.middleCols<kShapeColumns>(kLensColumns) =
        by_offset * corner_of_board(board, Eigen::Vector4d::Zero(), corner.point_board).by_shape;
    if (errors.print(view.board, 0) >= 0)
      others.middleCols<3>(kLensColumns + kShapeColumns + 3 * static_cast<Eigen::Index>(i)) = by_offset;
    if (fields > 0)
      others.rightCols(fields) = W * removed.fields[static_cast<std::size_t>(pose.view)].middleRows<2>(at);
  }
  return result;
}

void add_fine_rows(const FineNumbers* numbers, ViewRows* view) {
  if (numbers == nullptr) return;
  view->by_fine.resize(view->residual.size(), numbers->size());
  for (std::size_t i = 0; i < view->pixels.size(); ++i)
    view->by_fine.middleRows<2>(static_cast<Eigen::Index>(2 * i)) =
        FineNumbers::rows(view->whitening[i], numbers->at(view->pixels[i]));
}

Weighted weighted_by(const ViewRows& view, Eigen::VectorXd weights) {
  const Eigen::MatrixXd weighted_pose = view.by_pose.transpose() * weights.asDiagonal();
  Eigen::MatrixXd to_pose = -(weighted_pose * view.by_pose).ldlt().solve(weighted_pose);
  return {std::move(weights), std::move(to_pose)};
}

Weighted weighted(const ViewRows& view, const Eigen::VectorXd& fits, double level) {
  Eigen::VectorXd weights(view.residual.size());
  for (Eigen::Index i = 0; i < weights.size(); i += 2)
    weights.segment<2>(i).setConstant(CauchyLoss().weight(fits.segment<2>(i).squaredNorm() / level) / level);
  return weighted_by(view, std::move(weights));
}

}  // namespace rigproof::ml
