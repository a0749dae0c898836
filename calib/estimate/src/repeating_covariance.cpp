#include "rigproof/calib/estimate/repeating_covariance.h"

#include <algorithm>
#include <utility>

#include "repeating_couplings.h"

namespace rigproof::ml {
namespace {

// What errors of unit variance that nobody estimates make of the first globals: the solution answers to them as to
// noise. A column for each error.
Eigen::MatrixXd response_to(const Couplings& errors, const EliminatedSystem& eliminated,
                            const Eigen::MatrixXd& first_of_covariance) {
  const Eigen::MatrixXd by_poses = first_of_covariance * eliminated.pose_response().topRows(first_of_covariance.cols());
  Eigen::MatrixXd response = first_of_covariance * errors.with_globals;
  for (std::size_t pose = 0; pose < errors.of_pose.size(); ++pose) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(pose);
    for (const Couplings::Range& range : errors.of_pose[pose]) {
      const Eigen::Index size = range.end - range.first;
      response.middleCols(range.first, size) -=
          by_poses.middleCols<6>(at).lazyProduct(errors.with_poses.middleRows<6>(at).middleCols(range.first, size));
    }
  }
  return response;
}

}  // namespace

GlobalCovariance SolvedEquations::of_globals() const {
  const Eigen::Index globals = by_fine_fields.rows();
  if (globals == all.covariance.rows() && by_fine_fields.cols() == 0) return all;
  return {all.covariance.topLeftCorner(globals, globals) + by_fine_fields * by_fine_fields.transpose(),
          all.free_directions.topRows(globals), by_fine_fields.rowwise().squaredNorm()};
}

std::optional<SolvedEquations> solve_equations(const RemovedErrors& removed, const Problem& problem, const State& state,
                                               const std::function<void(ArrowSystem*)>& add_more) {
  const Eigen::Index globals = problem.layout().globals();
  const bool repeats = removed.errors.any();
  Couplings fine(0, 0, 0);
  ArrowSystem system = repeats ? problem.linearise_with(removed, state, Weighting::kInformation, &fine)
                               : problem.linearise(state, Weighting::kInformation, nullptr, nullptr);
  if (add_more) add_more(&system);
  auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  GlobalCovariance all = invert_information(eliminated->schur());
  Eigen::MatrixXd by_fine_fields(globals, 0);
  if (repeats) by_fine_fields = response_to(fine, *eliminated, all.covariance.topRows(globals));
  return SolvedEquations{std::move(system), std::move(*eliminated), std::move(all), std::move(by_fine_fields)};
}

std::optional<GroupSums> leverage_of_fine_fields(const RemovedErrors& removed, const Problem& problem,
                                                 const State& state) {
  const bool any = std::any_of(removed.fine.begin(), removed.fine.end(),
                               [](const RemovedErrors::Fine& fine) { return !fine.grids.empty(); });
  if (!any) return problem.empty_sums();
  Couplings fine(0, 0, 0);
  const ArrowSystem system = problem.linearise_with(removed, state, Weighting::kInformation, &fine);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  const Eigen::MatrixXd by_globals = response_to(fine, *eliminated, invert_information(eliminated->schur()).covariance);
  EliminatedSystem::PoseCovariance poses = eliminated->answer_to(fine.with_poses, by_globals);
  const Eigen::Index globals = problem.layout().globals();
  poses.with_globals = poses.with_globals.leftCols(globals).eval();
  const Eigen::MatrixXd first = by_globals.topRows(globals);
  GroupSums grown = problem.empty_sums();
  problem.add_leverage(state, poses, first * first.transpose(), &grown);
  return grown;
}

}  // namespace rigproof::ml
