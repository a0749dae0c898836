// How well odometry and images agree before anything is solved: what no solution could make good is not worth one.
#pragma once

#include "rigproof/calib/estimate/preparation.h"

namespace rigproof::ml {

/// Over the ways between two views of a camera, at the closed-form start: the median turn [rad] that odometry and
/// images are apart, and, twice since there are two of them, the median shift as a share of the median way; logarithms,
/// added.
double start_misfit(const Preparation& prepared);

/// Whether no solution from a start like this leaves the data in order.
/// @param as_is of the data as they are
bool is_hopeless(double misfit, double as_is);

}  // namespace rigproof::ml
