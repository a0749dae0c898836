// Cameras whose images lie in each other's folders.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis.h"
#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// Of each camera: how far its lens is from what is stated, with the smooth field that no distortion follows, as -2 ln
/// of their priors. The expectation is no more than the number of unknowns that the data tell.
std::vector<double> lens_strains(const Preparation& prepared, const Fit& fit);

/// `frames.exchanged`: two cameras whose lenses are far from what is stated, and are what is stated of each other.
/// Nothing else tells of whole folders that are exchanged, since depth and motion go with them; cameras whose stated
/// lenses are alike cannot be told apart.
/// @param refit a trial on some of the stops, with its strains
std::optional<Cause> find_exchanged_cameras(const Preparation& prepared, const Fit& fit, const Refit& refit);

}  // namespace rigproof::ml
