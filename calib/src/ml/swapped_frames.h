// Frames that were filed under another camera's name.
#pragma once

#include <string>
#include <vector>

#include "ml/noise.h"
#include "ml/state.h"
#include "rigproof/calib/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Stops at which a frame of one camera shows what the other must have seen.
struct SwappedFrames {
  int first = 0, second = 0;  ///< cameras
  std::vector<int> stops;
};

/// @param doubtful stops with a view or an odometry row that nothing else agrees with; only these are looked at
std::vector<SwappedFrames> find_swapped_frames(const Observations& observations, const std::vector<ViewPose>& views,
                                               const State& state, const std::vector<bool>& doubtful);
/// "frames of left and right are swapped at stops 3, 7".
std::string description_of(const SwappedFrames& swapped, const Observations& observations);

}  // namespace rigproof::ml
