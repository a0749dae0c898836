#include "rigproof/calib/estimate/repeating_covariance.h"

#include <utility>

namespace rigproof::ml {

GlobalCovariance SolvedEquations::of_globals() const {
  const Eigen::Index globals = with_poses.rows();
  if (globals == all.covariance.rows()) return all;
  return {all.covariance.topLeftCorner(globals, globals), all.free_directions.topRows(globals)};
}

std::optional<SolvedEquations> solve_equations(const RemovedErrors& removed, const Problem& problem, const State& state,
                                               const std::function<void(ArrowSystem*)>& add_more) {
  ArrowSystem system = removed.errors.any() ? problem.linearise_with(removed, state, Weighting::kInformation)
                                            : problem.linearise(state, Weighting::kInformation, nullptr, nullptr);
  if (add_more) add_more(&system);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  SolvedEquations solved{std::move(system), invert_information(eliminated->schur()), {}, {}};
  const Eigen::MatrixXd own = solved.all.covariance.topRows(problem.layout().globals());
  solved.with_poses = -own * eliminated->pose_response().topRows(own.cols());
  for (const FieldEquations& field : solved.system.fields)
    solved.with_fields.push_back(field.columns_of_inverse(solved.with_poses, own));
  return solved;
}

}  // namespace rigproof::ml
