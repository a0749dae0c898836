// How far an answer would be bent by what another solution of the same data allows for.
#pragma once

#include <optional>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// The covariance of a solution's unknowns by the levels by which uncertainty is stated, and the directions that the
/// data leave open; absent where the poses are not determined.
std::optional<GlobalCovariance> stated_covariance(const Preparation& prepared, const Fit& fit);

/// By how many of its standard deviations a pose of a camera in the robot is another without what `with` allows for; a
/// camera that moved during the drive has two.
/// @param covariance of the solution `with`
double bent_by(const State& without, const Preparation& prepared, const Fit& with, const GlobalCovariance& covariance);

/// From here on the answer is refused rather than doubted.
inline constexpr double kBentSigmas = 5.0;

}  // namespace rigproof::ml
