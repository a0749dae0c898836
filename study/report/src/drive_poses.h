// Where robot and board were, as far as the data or the truth tell.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/study/report/inspect.h"

namespace rigproof::inspect_detail {

struct DrivePoses {
  std::vector<Rigid3> driven;    ///< T_world_robot at each stop: the truth's, else by odometry
  std::vector<Rigid3> odometry;  ///< by odometry; with truth its first pose is put on the driven one
  /// Of each board the truth's, else as the first view tells whose camera has a pose.
  std::vector<std::optional<Rigid3>> T_world_board;
};
/// The input has a stop at least.
DrivePoses drive_poses(const InspectInput& input);

}  // namespace rigproof::inspect_detail
