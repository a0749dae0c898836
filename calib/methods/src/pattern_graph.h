// Which camera sees the board at which stop: a bipartite graph, and a spanning tree through its best edges.
#pragma once

#include <vector>

#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::rivals {

/// One connected part of the graph with a start for everything in it.
struct PatternPart {
  std::vector<int> cameras;  ///< the first is the root
  std::vector<int> stops;
  std::vector<Rigid3> T_camera_root;  ///< in the order of `cameras`
  std::vector<Rigid3> T_root_board;   ///< in the order of `stops`
};

/// Parts in the order of their first camera; cameras that saw no board are in none. Poses follow a spanning tree whose
/// edges have the most corners, then the most certain board pose.
std::vector<PatternPart> pattern_parts(const Observations& observations, const std::vector<ViewPose>& views);

}  // namespace rigproof::rivals
