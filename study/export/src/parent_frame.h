// The frame that exported poses are given in: the result's robot frame, or another one of the robot's tree.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/export/export.h"

namespace rigproof::exporting {

struct ParentFrame {
  std::string name;
  Rigid3 T_robot_parent;           ///< in the robot frame of the result, which is on the ground
  std::vector<std::string> notes;  ///< in sentences

  /// The estimate as a pose in this frame. One of which not all is known keeps its own, whose axes say what is.
  EstimatedTransform given_here(EstimatedTransform estimate) const;
};

/// @param robot the robot frame of the result
ParentFrame parent_frame(const std::string& robot, const FrameTree& tree, const ExportOptions& options);

/// "at 0, 0, 13.2 cm".
std::string place_text(const Rigid3& T);

/// Where the robot's tree has links of cameras on frames that nothing joins with the robot frame; empty: nowhere.
std::string note_of_other_parents(const std::vector<ExportCamera>& cameras, const FrameTree& tree);

}  // namespace rigproof::exporting
