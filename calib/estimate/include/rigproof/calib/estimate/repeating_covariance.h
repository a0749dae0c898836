// The covariance of a problem's globals with errors that repeat in every image.
#pragma once

#include <functional>
#include <optional>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// The normal equations of a problem with errors that repeat in every image, solved, by the information that the loss
/// keeps. What is left of the repeating errors counts as unknown: they are the last globals and the fields, each of
/// unit variance before any data.
struct SolvedEquations {
  ArrowSystem system;
  GlobalCovariance all;
  /// Rows of the inverse of the problem's own globals: the columns of poses, and of each field.
  Eigen::MatrixXd with_poses;
  std::vector<Eigen::MatrixXd> with_fields;

  /// Of the problem's own globals.
  GlobalCovariance of_globals() const;
};

/// Absent where the poses are not determined.
/// @param removed may hold no errors
/// @param add_more if given, adds what else is known of the globals to the normal equations
std::optional<SolvedEquations> solve_equations(const RemovedErrors& removed, const Problem& problem, const State& state,
                                               const std::function<void(ArrowSystem*)>& add_more = {});

}  // namespace rigproof::ml
