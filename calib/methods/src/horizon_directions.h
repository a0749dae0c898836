// The way ahead and the vertical in every camera, as a network sees them in single images.
#pragma once

#include <vector>

#include "directions.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/horizon_source.h"

namespace rigproof::rivals {

/// One entry a camera. Looked at are the images at the stops and in straight segments; the way ahead counts only where
/// the robot drives straight: in the segments, and at stops from which it goes on straight.
struct HorizonDirections {
  std::vector<Directions> ahead, up;
};
HorizonDirections directions_from_horizons(const MethodInput& input, const HorizonSource& source);

}  // namespace rigproof::rivals
