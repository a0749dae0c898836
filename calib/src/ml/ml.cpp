#include "rigproof/calib/ml.h"

#include <chrono>
#include <utility>

#include "ml/examination.h"
#include "ml/odometry_choice.h"
#include "ml/report.h"

namespace rigproof {
namespace {

void solve(const ml::Preparation& prepared, MlEstimate* estimate) {
  Result& result = estimate->result;
  if (!prepared.solvable()) {
    result.reasons.push_back("No camera ever saw the board: nothing can be calibrated.");
    ml::report_use(prepared, nullptr, &result);
    return;
  }
  estimate->motion = prepared.motion;
  ml::OdometryChoice choice = ml::choose_odometry(prepared);
  estimate->odometry = choice.decision;
  const ml::Examination found = ml::examine(prepared, choice.fit);
  result.notes = std::move(choice.notes);
  result.notes.insert(result.notes.end(), found.notes.begin(), found.notes.end());
  ml::report_solution(prepared, choice.fit, choice.other ? &*choice.other : nullptr, found, estimate);
  ml::report_use(prepared, &choice.fit, &result);
}

}  // namespace

MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  MlEstimate estimate;
  estimate.result.method = "ml";
  const ml::Preparation prepared(observations, options);
  solve(prepared, &estimate);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  estimate.result.solve_s = elapsed.count();
  return estimate;
}

}  // namespace rigproof
