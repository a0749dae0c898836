// The frame that results are given in, and where it lies in the one that odometry moves.
#pragma once

#include <string>
#include <vector>

#include "bag_survey.h"

namespace rigproof {

struct RobotFrame {
  std::string name;
  Rigid3 T_child_robot;            ///< in the frame that odometry moves
  std::vector<std::string> notes;  ///< what nobody says and is taken so
};

/// @param given what the user calls it; empty: base_footprint
/// Throws Error for a frame that the robot does not have, one that nothing joins with odometry, and one that stands
/// above the ground: what calibrates is a point on it.
RobotFrame robot_frame_of(const FrameTree& tree, const PoseTopic& odometry, const std::string& given);

}  // namespace rigproof
