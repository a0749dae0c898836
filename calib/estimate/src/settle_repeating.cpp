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

// The step that the whole problem makes of the errors at a solution without them; none where the poses are not
// determined. All of it enters linearly, but for weights and levels.
void step_jointly(const Preparation& prepared, const Fit& fit, RemovedErrors* repeating) {
  const Problem problem = problem_at(prepared, fit, fit.noise);
  const ArrowSystem system = problem.linearise_with(*repeating, fit.state, Weighting::kRobust);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return;
  const Eigen::VectorXd globals = -(invert_information(eliminated->schur()).covariance * eliminated->schur_gradient());
  const Eigen::MatrixXd response = eliminated->pose_response();
  const Eigen::VectorXd poses =
      -response.bottomRows<1>().transpose() - response.topRows(globals.size()).transpose() * globals;
  repeating->value += globals.tail(repeating->errors.size());
  auto field = system.fields.begin();
  for (RemovedErrors::Fine& fine : repeating->fine)
    if (fine.numbers) fine.value += (field++)->step(poses, globals);
}

}  // namespace

void settle_repeating(Preparation* prepared) {
  const std::vector<BoardView> seen = prepared->used.board_views;
  RemovedErrors& repeating = prepared->repeating;
  estimate_repeating(prepared->used, prepared->views, prepared->priors, prepared->options.repeating.get(), &repeating);
  take_out(seen, prepared);
  const bool per_pose = prepared->used.odometry_noise.model == OdometryModel::kPerPose;
  const OdometryLaw law{per_pose ? OdometryModel::kPerPose : OdometryModel::kPerIncrement, false};
  const Fit fit = fit_model(*prepared, law);
  step_jointly(*prepared, fit, &repeating);
  take_out(seen, prepared);
  if (!per_pose) prepared->start = fit.state;
}

void settle_again(Preparation* prepared, const Fit& before) {
  if (!prepared->repeating.errors.any()) return;
  step_jointly(*prepared, before, &prepared->repeating);
  take_out(prepared->original.board_views, prepared);
}

}  // namespace rigproof::ml
