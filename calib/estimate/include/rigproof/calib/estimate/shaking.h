// Cameras whose images are displaced as a whole from stop to stop: on a loose mount, or of other moments than told.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/calib/estimate/fit.h"

namespace rigproof::ml {

/// How much more the views of a camera scatter about where all others hold them than their corners' noise says.
struct Shaking {
  double redundancy = 0.0;    ///< dimensions of the views' attitudes that the estimate does not absorb
  double ratio = 1.0;         ///< variance of the views' attitudes over that by the level of the corners
  double displaced_px = 0.0;  ///< root mean square of the corners' displacement that goes with it
};

/// Of each camera, from the stops at which another one sees the board, too, and where it stands.
std::vector<Shaking> shaking_of_cameras(const Problem& problem, const State& state);

/// Whether images of some camera are displaced as a whole from stop to stop, beyond what the fit counts with.
bool shakes_anywhere(const Preparation& prepared, const Fit& fit);

/// The same where images of some camera are displaced as a whole from stop to stop: all of a view's corners then err
/// alike, and count for as little as its pose is known by. Absent where none are.
std::optional<Fit> fit_with_shaking(const Preparation& prepared, const Fit& without);

}  // namespace rigproof::ml
