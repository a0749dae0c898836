#include "global_covariance.h"

#include "rigproof/calib/estimate/repeating_covariance.h"

namespace rigproof::ml {

std::optional<GlobalCovariance> covariance_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels) {
  const auto solved = solve_equations(prepared.repeating, problem_at(prepared, fit, levels), fit.state);
  if (!solved) return std::nullopt;
  return solved->of_globals();
}

}  // namespace rigproof::ml
