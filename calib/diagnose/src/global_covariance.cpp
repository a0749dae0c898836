#include "global_covariance.h"

namespace rigproof::ml {

std::optional<GlobalCovariance> covariance_of(const ArrowSystem& system) {
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  return invert_information(eliminated->schur());
}

std::optional<GlobalCovariance> covariance_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels) {
  const Problem problem = problem_at(prepared, fit, levels);
  if (!prepared.repeating.errors.any())
    return covariance_of(problem.linearise(fit.state, Weighting::kInformation, nullptr, nullptr));
  std::optional<GlobalCovariance> all =
      covariance_of(problem.linearise_with(prepared.repeating, fit.state, Weighting::kInformation));
  if (!all) return std::nullopt;
  const Eigen::Index globals = problem.layout().globals();
  all->covariance = all->covariance.topLeftCorner(globals, globals).eval();
  all->free_directions = all->free_directions.topRows(globals).eval();
  return all;
}

}  // namespace rigproof::ml
