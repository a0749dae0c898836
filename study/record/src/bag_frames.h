// Names of frames in a bag, and its /tf_static.
#pragma once

#include <string>

#include "rigproof/core/recording.h"
#include "rigproof/formats/frame_tree.h"

namespace rigproof {

/// Of the pictures' headers.
std::string optical_frame_in_bag(const RigCamera& camera);
std::string depth_frame_in_bag(const RigCamera& camera);
/// What the robot would publish. Throws Error for a tf_static.json that cannot be read.
FrameTree frames_of_bag(const Recording& recording);

}  // namespace rigproof
