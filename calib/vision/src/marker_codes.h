// What markers of OpenCV's dictionaries look like.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/board_markers.h"

namespace rigproof::detection {

/// The first `count` markers of a dictionary, with a border of so many cells (1 to 3) and white around it: light 1,
/// dark 0, rows from the top, (bits + 6)^2.
std::vector<Eigen::MatrixXf> marker_pictures(const MarkerDictionary& dictionary, int count, int border);

}  // namespace rigproof::detection
