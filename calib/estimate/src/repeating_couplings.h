// How repeating errors enter the normal equations: with each other, with the globals and with every pose.
#pragma once

#include "board_in_camera.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

class RepeatingCouplings {
 public:
  RepeatingCouplings(const RemovedErrors& removed, int poses, int globals);
  /// The corners of a board view.
  void add(const Evaluation& at, std::size_t index, const WhitenedView& view);
  /// The errors are the last globals of the system; with their priors.
  void add_to(ArrowSystem* system) const;

 private:
  // At `place` among the raw errors; by the view's twist, its lens and the board's shape.
  void add_with_others(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen, int place,
                       const Eigen::MatrixXd& by_globals);

  const RemovedErrors& removed_;
  const RepeatingErrors& errors_;
  // By the raw errors.
  Eigen::MatrixXd own_, with_globals_;
  PoseRows with_poses_;
  Eigen::VectorXd gradient_;
};

}  // namespace rigproof::ml
