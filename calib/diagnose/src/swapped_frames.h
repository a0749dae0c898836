// Frames that were filed under another camera's name.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Stops at which a frame of one camera shows what the other camera should have seen.
struct SwappedFrames {
  int first = 0, second = 0;  ///< cameras
  std::vector<int> stops;
};

/// @param doubtful stops with a view or an odometry row that nothing else agrees with; only these are looked at
std::vector<SwappedFrames> find_swapped_frames(const Observations& observations, const std::vector<ViewPose>& views,
                                               const State& state, const std::vector<bool>& doubtful);
/// Those of them for which the likelihood prefers the swap: a stop with a wild odometry row is also predicted wrongly,
/// and by chance that prediction may match another camera.
/// @param problem at the solution's levels, with what was left out
std::vector<SwappedFrames> likelier_swapped(const Problem& problem, const State& state,
                                            const std::vector<SwappedFrames>& candidates);
/// frames.swapped.
Finding finding_of(const SwappedFrames& swapped, const Observations& observations);

}  // namespace rigproof::ml
