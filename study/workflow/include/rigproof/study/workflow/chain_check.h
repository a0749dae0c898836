// What calibrates cameras against each other, Kalibr say, and the robot's calibration must agree about how they stand.
#pragma once

#include <filesystem>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/result.h"
#include "rigproof/formats/frame_tree.h"

namespace rigproof {

/// One finding for each pair of cameras that is solved whole, with its uncertainty, and that the chain knows:
/// cameras.as_in_chain, or cameras.other_than_in_chain where chance explains the difference once in 10,000 times.
/// A camchain states no uncertainty. What people's calibrators leave is taken for it: squares are known to .5 % (as
/// boards are that nobody measured), and so is the distance between cameras; a principal point is known to a pixel,
/// which at 600 px of focal length is .1 deg, and 2 mm on a board a metre away.
std::vector<Finding> compare_with_chain(const Result& result, const FrameTree& chain);

/// The camchain.json of a recording; empty where it has none. Throws Error for one that cannot be read, or in which
/// cameras do not hang on each other as a tree.
FrameTree load_chain(const std::filesystem::path& folder);

}  // namespace rigproof
