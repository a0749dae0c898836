// FIELD=VALUE overrides of a configuration.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// {"poses=20", "odometry.lambda=5", "odometry.model=per_pose"} as YAML blocks that may be read after an include.
/// VALUE is YAML itself, so lists and distributions work: "board.x_m={uniform: [1, 2]}". The last override of a field
/// wins. Throws Error that shows the override which has no FIELD= in front.
std::string overrides_as_yaml(const std::vector<std::string>& overrides);

}  // namespace rigproof
