// Which remedy each line of the uncertainty's budget has, and how axes of the robot are called.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace rigproof {

/// Of the error's axes, as findings call them: along and about the robot's x, y and z.
inline constexpr std::array<const char*, 6> kRobotAxes = {"x", "y", "z", "roll", "pitch", "yaw"};

/// What to measure, where a line of the budget holds what was stated, not what was seen: `measure` of the findings.
std::optional<std::string> measurement_for(const std::string& source);

}  // namespace rigproof
