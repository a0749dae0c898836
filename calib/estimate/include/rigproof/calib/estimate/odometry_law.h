// How the noise of odometry grows.
#pragma once

#include "rigproof/core/rig.h"

namespace rigproof {

struct OdometryLaw {
  OdometryModel model = OdometryModel::kPerIncrement;
  /// With kPerIncrement only: the sigmas hold after one metre and after a turn of one radian, and grow with the square
  /// root of either along Stop::way; an error of a turn bends the path after it.
  bool along_way = false;
  /// Along the way, a metre loses as much heading as this turn, besides what it turns.
  double metre_as_turn_rad = 0.1;
};

}  // namespace rigproof
