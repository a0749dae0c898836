// What the corners of single images tell, wherever the board lies: rows of least squares.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Columns of a lens (LensChange) and of the board's shape.
constexpr int kLensColumns = 5, kShapeColumns = 4;

/// Rows of a view's corners, two each, whitened by what is stated; zero where a corner has no use.
struct ViewRows {
  int camera, board;
  std::vector<int> raw;  ///< of each column after lens and shape: its place among the raw errors
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_pose;    ///< chart of transform_error()
  Eigen::MatrixXd by_others;  ///< lens, shape, offset of each corner, field
  /// Where corners should be by the view's pose [px]: columns taken at the seen ones would hold their noise.
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Matrix2d> whitening;
  Eigen::MatrixXd by_fine;  ///< numbers of the fine field; none until add_fine_rows()
};

/// @param numbers null: none
void add_fine_rows(const FineNumbers* numbers, ViewRows* view);
ViewRows rows_of(const ViewPose& pose, const RemovedErrors& removed, const Observations& observations);

/// Rows of a view by how well they fit, and what the view's pose makes of them.
struct Weighted {
  Eigen::VectorXd weights;  ///< of each row
  Eigen::MatrixXd to_pose;  ///< the step of the pose that fits a residual best is this times the residual; 6 x rows
};
Weighted weighted_by(const ViewRows& view, Eigen::VectorXd weights);
/// @param fits how the rows fit so far
/// @param level square of what corners scatter by, as a multiple of what is stated
Weighted weighted(const ViewRows& view, const Eigen::VectorXd& fits, double level);

}  // namespace rigproof::ml
