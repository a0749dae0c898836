// Depth whose planes are of another shape than the answer allows for.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// The depth cameras whose planes of ground and board fit images and motion only if their image is shifted, turned or
/// warped against the colour camera's: `depth.misplaced`, one a camera. The answer knows of depth that is too far, and
/// of a depth camera that is tilted as a body; this is any other linear change of what it shows.
std::vector<Finding> find_misplaced_depth(const Preparation& prepared, const Fit& fit);

}  // namespace rigproof::ml
