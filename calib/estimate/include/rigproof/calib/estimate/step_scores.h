// What a step of a camera, of all of them, or of the board, at some stop of the drive would explain: score tests at a
// solution without one.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/state.h"

namespace rigproof::ml {

/// Every body needs so many views before a step and after it: fewer wrong ones are outvoted, and named by themselves.
inline constexpr int kLeastViewsOfStep = 3;

struct StepScore {
  Step step;
  /// Chi-square of up to six dimensions if nothing moved: the score of six more unknowns (the pose of a camera, of all
  /// cameras as one body, or of the board from the split on) by its information, all other unknowns following.
  double square = 0.0;
};

/// At most `most` of the splits 1 to stops - 1, evenly.
std::vector<int> splits_of(int stops, int most);

}  // namespace rigproof::ml
