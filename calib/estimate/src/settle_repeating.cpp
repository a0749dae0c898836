#include "settle_repeating.h"

#include <utility>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {
namespace {

// Out of the corners as they were seen.
void take_out(const std::vector<BoardView>& seen, Preparation* prepared) {
  prepared->used.board_views = seen;
  remove_repeating(prepared->repeating, prepared->views, &prepared->used);
  prepared->whitened = std::make_shared<const Whitened>(with_corners_of(prepared->used, *prepared->whitened));
}

// The step that the whole problem makes of the errors at a solution without them; zero where the poses are not
// determined.
Eigen::VectorXd joint_step(const Preparation& prepared, const Fit& fit) {
  const Eigen::Index size = prepared.repeating.errors.size();
  const Problem problem = problem_at(prepared, fit, fit.noise);
  const auto eliminated =
      EliminatedSystem::eliminate(problem.linearise_with(prepared.repeating, fit.state, Weighting::kRobust), 0.0);
  if (!eliminated) return Eigen::VectorXd::Zero(size);
  const Eigen::MatrixXd covariance = invert_information(eliminated->schur()).covariance;
  return -(covariance.bottomRows(size) * eliminated->schur_gradient());
}

}  // namespace

void settle_repeating(Preparation* prepared) {
  const std::vector<BoardView> seen = prepared->used.board_views;
  RemovedErrors& repeating = prepared->repeating;
  estimate_repeating(prepared->used, prepared->views, prepared->priors, &repeating);
  take_out(seen, prepared);
  const bool per_pose = prepared->used.odometry_noise.model == OdometryModel::kPerPose;
  const OdometryLaw law{per_pose ? OdometryModel::kPerPose : OdometryModel::kPerIncrement, false};
  const Fit fit = fit_model(*prepared, law);
  repeating.value += joint_step(*prepared, fit);  // all of it enters linearly, but for weights and levels
  take_out(seen, prepared);
  if (!per_pose) prepared->start = fit.state;
}

void settle_again(Preparation* prepared, const Fit& before) {
  if (!prepared->repeating.errors.any()) return;
  prepared->repeating.value += joint_step(*prepared, before);
  take_out(prepared->original.board_views, prepared);
}

}  // namespace rigproof::ml
