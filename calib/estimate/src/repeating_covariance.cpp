#include "rigproof/calib/estimate/repeating_covariance.h"

#include "repeating_couplings.h"

namespace rigproof::ml {
namespace {

// What errors of unit variance that nobody estimates make of the first globals: the solution answers to them as to
// noise. A column for each error.
Eigen::MatrixXd response_to(const Couplings& errors, const EliminatedSystem& eliminated,
                            const Eigen::MatrixXd& first_of_covariance) {
  const Eigen::MatrixXd by_poses = first_of_covariance * eliminated.pose_response().topRows(first_of_covariance.cols());
  return first_of_covariance * errors.with_globals - by_poses * errors.with_poses;
}

}  // namespace

std::optional<GlobalCovariance> covariance_with(const RemovedErrors& removed, const Problem& problem,
                                                const State& state) {
  Couplings fine(0, 0, 0);
  const ArrowSystem system = problem.linearise_with(removed, state, Weighting::kInformation, &fine);
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  GlobalCovariance all = invert_information(eliminated->schur());
  const Eigen::Index globals = problem.layout().globals();
  const Eigen::MatrixXd response = response_to(fine, *eliminated, all.covariance.topRows(globals));
  return GlobalCovariance{all.covariance.topLeftCorner(globals, globals) + response * response.transpose(),
                          all.free_directions.topRows(globals), response.rowwise().squaredNorm()};
}

}  // namespace rigproof::ml
