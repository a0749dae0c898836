#include "rigproof/calib/diagnose/ml.h"

#include <chrono>

#include "board_places.h"
#include "report.h"
#include "rigproof/calib/diagnose/basis.h"
#include "rigproof/calib/estimate/shaking.h"

namespace rigproof {
namespace {

Observations without_left_out(const ml::Preparation& prepared, const ml::Fit& fit) {
  Observations used = prepared.used;
  used.board_views.clear();
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (!fit.view_left_out[v]) used.board_views.push_back(prepared.used.board_views[v]);
  return used;
}

// Last: what is wrong otherwise displaces images, too. A cause that leaves them displaced gives way where nothing else
// is wrong once that is allowed for.
void allow_for_shaking(const ml::Preparation& prepared, ml::OdometryChoice* choice, ml::Examination* found) {
  if (!found->wrong_frames.empty() || (found->cause && !found->cause->leaves_shaking)) return;
  const std::optional<ml::Fit> shaken = ml::fit_with_shaking(prepared, choice->fit);
  if (!shaken) return;
  const ml::Examination allowed = found->cause ? ml::examine(prepared, *shaken) : *found;
  if (found->cause && !allowed.is_in_order()) return;
  if (const std::optional<ml::Cause> cause = ml::cause_without_excuses(prepared, choice->fit)) {
    found->cause = cause;
    return;
  }
  *found = allowed;
  choice->fit = *shaken;
  if (choice->other)
    if (const std::optional<ml::Fit> other = ml::fit_with_shaking(prepared, *choice->other)) choice->other = other;
  found->sums = ml::problem_at(prepared, *shaken, shaken->noise).sums_with_leverage(shaken->state);
  for (std::size_t c = 0; c < shaken->shaken_px.size(); ++c)
    if (const double by_px = shaken->shaken_px[c]; by_px > 0.0)
      found->notes.push_back(Finding("images.shaken", {{"by_px", by_px}}).of(prepared.used.cameras[c].name));
}

MlEstimate solve(const Observations& observations, const MlOptions& options, std::optional<ml::Basis>* basis) {
  ml::Preparation prepared = ml::prepare(observations, options);
  if (!prepared.solvable()) return ml::report_unsolvable(prepared);
  ml::OdometryChoice choice = ml::choose_odometry(prepared);
  ml::Examination found = ml::examine(prepared, choice.fit);
  allow_for_shaking(prepared, &choice, &found);
  ml::use_stated_places(&prepared, &choice, &found);
  const ml::Statement stated = ml::state_solution(prepared, choice, found);
  if (basis != nullptr)
    *basis = ml::Basis{without_left_out(prepared, choice.fit),
                       prepared.guess,
                       choice.fit.state,
                       prepared.priors,
                       stated.levels,
                       stated.system};
  return ml::report(prepared, choice, found, stated);
}

}  // namespace

MlEstimate ml::estimate_with_basis(const Observations& observations, const MlOptions& options,
                                   std::optional<Basis>* basis) {
  const auto begin = std::chrono::steady_clock::now();
  MlEstimate estimate = solve(observations, options, basis);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  estimate.result.method = "ml";
  estimate.result.solve_s = elapsed.count();
  return estimate;
}

MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options) {
  return ml::estimate_with_basis(observations, options, nullptr);
}

}  // namespace rigproof
