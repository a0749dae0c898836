// The covariance of a problem's globals with errors that repeat in every image.
#pragma once

#include <functional>
#include <optional>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// Of all globals but the repeating errors, by the information that the loss keeps; absent where the poses are not
/// determined. What is left of the repeating errors counts as unknown, and what no polynomial follows of the lenses
/// as errors that the solution does not know of.
/// @param add_more if given, adds what else is known of the globals to the normal equations
std::optional<GlobalCovariance> covariance_with(const RemovedErrors& removed, const Problem& problem,
                                                const State& state,
                                                const std::function<void(ArrowSystem*)>& add_more = {});

/// Of each group: how much larger its squares are for what no polynomial follows of the lenses, in dimensions, since
/// the solution does not know of it; absent where the poses are not determined. Of groups that those displacements
/// themselves are part of (corners) it tells nothing.
std::optional<GroupSums> leverage_of_fine_fields(const RemovedErrors& removed, const Problem& problem,
                                                 const State& state);

}  // namespace rigproof::ml
