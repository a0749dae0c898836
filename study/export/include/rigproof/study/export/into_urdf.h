// Poses into an existing URDF or xacro file: the <origin> of one joint a camera changes, and no other byte.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/export/export.h"

namespace rigproof {

/// A joint that has been given a new origin.
struct ChangedJoint {
  std::string camera;
  std::string joint;
  std::string parent, child;  ///< links
  int line = 0;
  std::string optical;                 ///< the link that the camera's pose was taken for
  std::vector<std::string> others;     ///< joints that could have been changed instead
  std::string xyz_before, rpy_before;  ///< as in the file; empty where there was nothing
  std::string xyz_after, rpy_after;
  double moved_m = 0.0;
  double turned_rad = 0.0;
};

struct IntoUrdf {
  std::string text;
  std::vector<ChangedJoint> joints;  ///< in the order of the cameras
  std::vector<std::string> notes;
};

/// Every known camera of the job into the text of a URDF. The chain from the pose's parent to the camera must be of
/// fixed joints. Throws Error with every problem: what is no URDF, links that are not there, joints that move, loops,
/// several parents, expressions where numbers are needed.
/// @param file for messages
IntoUrdf export_into_urdf(const ExportJob& job, const std::string& text, const std::string& file);

}  // namespace rigproof
