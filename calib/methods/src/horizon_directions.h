// The forward direction and the vertical in every camera, from a network's answers to single images.
#pragma once

#include <vector>

#include "directions.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/horizon_source.h"

namespace rigproof::rivals {

/// One entry a camera, from the images at the stops and in straight segments. The forward direction counts only where
/// the robot drives straight: in the segments, and at stops from which it continues straight.
struct HorizonDirections {
  std::vector<Directions> ahead, up;
};
HorizonDirections directions_from_horizons(const MethodInput& input, const HorizonSource& source);

}  // namespace rigproof::rivals
