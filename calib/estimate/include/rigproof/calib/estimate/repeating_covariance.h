// The covariance of a problem's globals with errors that repeat in every image.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// Of all globals but the repeating errors, by the information that the loss keeps; absent where the poses are not
/// determined. What is left of the repeating errors counts as unknown, and what no polynomial follows of the lenses
/// as errors that the solution does not know of.
std::optional<GlobalCovariance> covariance_with(const RemovedErrors& removed, const Problem& problem,
                                                const State& state);

}  // namespace rigproof::ml
