// From images, clouds and odometry to the answer of the authors' program of MEMROC, link by link, and the same with
// links of ours in their place.
#pragma once

#include "rigproof/calib/input/method_input.h"
#include "rigproof/core/result.h"

namespace rigproof::rivals {

/// The last link that is replaced: each stands for itself and all before it.
enum class ChainLink {
  kNone,      ///< the authors' own chain
  kCorners,   ///< corners as observed, instead of OpenCV's
  kPnp,       ///< every view's weighted PnP, instead of RANSAC's and only where all corners are inliers
  kPlanes,    ///< planes fitted with the sensor's noise, instead of the most points within 0.1 mm
  kVertical,  ///< the vertical of the whole drive, with the lever arm, instead of aligned paths and a signed normal
  kStart,     ///< a closed form, instead of the board's axes taken for the robot's
  kResidual,  ///< the angle between rotations, and the heights of all frames by themselves, instead of one block
};

/// Never throws on data, but Error with ExitCode::kTryAgain if it is interrupted.
Result solve_chain(const MethodInput& input, bool joint, ChainLink replaced);

}  // namespace rigproof::rivals
