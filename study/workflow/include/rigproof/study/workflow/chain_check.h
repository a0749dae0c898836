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
/// A camchain states no uncertainty. What people's calibrators leave is taken for it: a board's squares are known to
/// .5 %, and so is the distance between cameras; a principal point is known to a pixel, .1 deg at 600 px of focal
/// length; and 2 mm.
std::vector<Finding> compare_with_chain(const Result& result, const FrameTree& chain);

/// The same for the camchain.json of a recording; nothing where it has none. Throws Error for one that cannot be read.
std::vector<Finding> compare_with_chain(const Result& result, const std::filesystem::path& folder);

}  // namespace rigproof
