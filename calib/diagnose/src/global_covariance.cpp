#include "global_covariance.h"

#include "rigproof/calib/estimate/repeating_covariance.h"

namespace rigproof::ml {

std::optional<GlobalCovariance> covariance_of(const ArrowSystem& system) {
  const auto eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  return invert_information(eliminated->schur());
}

std::optional<GlobalCovariance> covariance_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels) {
  const Problem problem = problem_at(prepared, fit, levels);
  if (prepared.repeating.errors.any()) return covariance_with(prepared.repeating, problem, fit.state);
  return covariance_of(problem.linearise(fit.state, Weighting::kInformation, nullptr, nullptr));
}

}  // namespace rigproof::ml
