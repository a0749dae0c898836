#include "rigproof/calib/diagnose/ml.h"

#include <chrono>
#include <utility>

#include "examination.h"
#include "report.h"
#include "rigproof/calib/diagnose/basis.h"
#include "rigproof/calib/estimate/odometry_choice.h"
#include "rigproof/calib/estimate/stated_levels.h"

namespace rigproof {
namespace {

Observations without_left_out(const ml::Preparation& prepared, const ml::Fit& fit) {
  Observations used = prepared.used;
  used.board_views.clear();
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (!fit.view_left_out[v]) used.board_views.push_back(prepared.used.board_views[v]);
  return used;
}

ml::Basis basis_of(const ml::Preparation& prepared, const ml::Fit& fit, const ml::Examination& found) {
  const ml::NoiseLevels levels = found.sums ? ml::stated_levels(prepared, fit, *found.sums) : fit.noise;
  return {without_left_out(prepared, fit),
          prepared.guess,
          fit.state,
          prepared.priors,
          levels,
          ml::problem_at(prepared, fit, levels).linearise(fit.state, ml::Weighting::kInformation, nullptr, nullptr)};
}

void solve(const ml::Preparation& prepared, MlEstimate* estimate, std::optional<ml::Basis>* basis) {
  Result& result = estimate->result;
  if (!prepared.solvable()) {
    result.reasons.emplace_back("board.never_seen");
    ml::report_use(prepared, nullptr, &result);
    return;
  }
  estimate->motion = ml::motion_of(prepared);
  ml::OdometryChoice choice = ml::choose_odometry(prepared);
  estimate->odometry = choice.decision;
  const ml::Examination found = ml::examine(prepared, choice.fit, estimate->motion);
  result.notes = std::move(choice.notes);
  result.notes.insert(result.notes.end(), found.notes.begin(), found.notes.end());
  ml::report_solution(prepared, choice.fit, choice.other ? &*choice.other : nullptr, found, estimate);
  ml::report_use(prepared, &choice.fit, &result);
  if (basis != nullptr) *basis = basis_of(prepared, choice.fit, found);
}

}  // namespace

MlEstimate ml::estimate_with_basis(const Observations& observations, const MlOptions& options,
                                   std::optional<Basis>* basis) {
  const auto begin = std::chrono::steady_clock::now();
  MlEstimate estimate;
  estimate.result.method = "ml";
  const Preparation prepared(observations, options);
  solve(prepared, &estimate, basis);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  estimate.result.solve_s = elapsed.count();
  return estimate;
}

MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options) {
  return ml::estimate_with_basis(observations, options, nullptr);
}

}  // namespace rigproof
