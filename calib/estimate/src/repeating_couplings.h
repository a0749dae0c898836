// How repeating errors enter the normal equations: with each other, with the globals and with every pose.
#pragma once

#include <optional>
#include <vector>

#include "board_in_camera.h"
#include "fine_numbers.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

class RepeatingCouplings {
 public:
  RepeatingCouplings(const RemovedErrors& removed, int poses, int globals);
  /// The corners of a board view.
  void add(const Evaluation& at, std::size_t index, const WhitenedView& view);
  /// The errors are the last globals of the system, fine fields its fields; with their priors. Once, after all views.
  void add_to(ArrowSystem* system);

 private:
  struct Rows;
  Rows rows_of(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, std::size_t index) const;
  // A camera's fine field.
  struct Fine {
    const FineNumbers* numbers;
    FineSquares squares;
    FieldEquations equations;  // with the problem's own globals; without the squares
    Eigen::MatrixXd with_raw;  // a row for each raw error
  };
  void add_print(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, const Rows& rows);
  void add_fine(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, const Rows& rows,
                Fine* fine) const;

  const RemovedErrors& removed_;
  const RepeatingErrors& errors_;
  PoseRows raw_with_poses_;  // a column for each raw error
  Eigen::MatrixXd raw_with_globals_;
  Eigen::MatrixXd own_;  // by the raw errors
  Eigen::VectorXd gradient_;
  std::vector<std::optional<Fine>> fine_;  // of each camera
};

}  // namespace rigproof::ml
