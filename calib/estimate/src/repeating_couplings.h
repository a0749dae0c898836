// How repeating errors enter the normal equations: with each other, with the globals and with every pose.
#pragma once

#include <optional>
#include <vector>

#include "board_in_camera.h"
#include "fine_field.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// How errors of corners enter the normal equations with the globals and with every pose; a column for each error.
struct Couplings {
  Couplings(int poses, int globals, int errors)
      : with_globals(Eigen::MatrixXd::Zero(globals, errors)),
        with_poses(PoseRows::Zero(6 * poses, errors)),
        of_pose(static_cast<std::size_t>(poses)) {}
  /// @param place of the first error @param by_globals by the view's twist, its lens and the board's shape
  void add(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, int place,
           const Eigen::MatrixXd& by_globals);

  struct Range {
    int first, end;  // of errors
  };
  /// Notes that a pose is coupled with these errors: ranges that overlap or touch become one.
  void add_range(int pose, Range range);

  Eigen::MatrixXd with_globals;
  PoseRows with_poses;
  std::vector<std::vector<Range>> of_pose;  ///< the errors that each pose is coupled with; no two overlap
};

class RepeatingCouplings {
 public:
  /// @param with_fine also of what no polynomial follows
  RepeatingCouplings(const RemovedErrors& removed, int poses, int globals, bool with_fine);
  /// The corners of a board view.
  void add(const Evaluation& at, std::size_t index, const WhitenedView& view);
  /// The errors are the last globals of the system; with their priors.
  void add_to(ArrowSystem* system) const;
  /// Of the fine fields, a column for each unit of a node's prior; their globals include the repeating errors.
  Couplings of_fine_fields() const;

 private:
  struct Rows;
  Rows rows_of(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, std::size_t index) const;
  // A grid of a camera's fine field.
  struct GridColumns {
    FineField field;
    int first;  // of its columns
    double sigma_px;
  };
  void add_print(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, const Rows& rows);
  void add_fine(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, const Rows& rows,
                const GridColumns& grid);

  const RemovedErrors& removed_;
  const RepeatingErrors& errors_;
  Couplings raw_;
  Eigen::MatrixXd own_;  // by the raw errors
  Eigen::VectorXd gradient_;
  std::vector<std::vector<GridColumns>> fine_grids_;  // of each camera
  Couplings fine_;
  Eigen::MatrixXd raw_with_fine_;
};

}  // namespace rigproof::ml
