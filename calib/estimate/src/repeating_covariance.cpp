#include "rigproof/calib/estimate/repeating_covariance.h"

#include <algorithm>

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

std::optional<GlobalCovariance> covariance_with(const RemovedErrors& removed, const Problem& problem,
                                                const State& state, const std::function<void(ArrowSystem*)>& add_more) {
  Couplings fine(0, 0, 0);
  ArrowSystem system = problem.linearise_with(removed, state, Weighting::kInformation, &fine);
  if (add_more) add_more(&system);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  GlobalCovariance all = invert_information(eliminated->schur());
  const Eigen::Index globals = problem.layout().globals();
  const Eigen::MatrixXd response = response_to(fine, *eliminated, all.covariance.topRows(globals));
  return GlobalCovariance{all.covariance.topLeftCorner(globals, globals) + response * response.transpose(),
                          all.free_directions.topRows(globals), response.rowwise().squaredNorm()};
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
