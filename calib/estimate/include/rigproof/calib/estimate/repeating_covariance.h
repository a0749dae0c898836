// The covariance of a problem's globals with errors that repeat in every image.
#pragma once

#include <functional>
#include <optional>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// The normal equations of a problem with errors that repeat in every image, solved, by the information that the loss
/// keeps. What is left of the repeating errors counts as unknown: they are the last globals, each of unit variance
/// before any data.
struct SolvedEquations {
  ArrowSystem system;
  EliminatedSystem eliminated;
  GlobalCovariance all;
  /// What no polynomial follows of the lenses, of which the solution does not know: what it makes of the problem's own
  /// globals, a column for each error of unit variance.
  Eigen::MatrixXd by_fine_fields;

  /// Of the problem's own globals, with what the fine fields make of them.
  GlobalCovariance of_globals() const;
};

/// Absent where the poses are not determined.
/// @param removed may hold no errors
/// @param add_more if given, adds what else is known of the globals to the normal equations
std::optional<SolvedEquations> solve_equations(const RemovedErrors& removed, const Problem& problem, const State& state,
                                               const std::function<void(ArrowSystem*)>& add_more = {});

/// Of each group: how much larger its squares are for what no polynomial follows of the lenses, in dimensions, since
/// the solution does not know of it; absent where the poses are not determined. Of groups that those displacements
/// themselves are part of (corners) it tells nothing.
std::optional<GroupSums> leverage_of_fine_fields(const RemovedErrors& removed, const Problem& problem,
                                                 const State& state);

}  // namespace rigproof::ml
