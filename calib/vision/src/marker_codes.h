// What markers of OpenCV's dictionaries look like.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/board_markers.h"

namespace rigproof::detection {

/// The first `count` markers of a dictionary, border and two cells of white around it included: light 1, dark 0, rows
/// from the top, (bits + 6)^2.
std::vector<Eigen::MatrixXf> marker_pictures(const MarkerDictionary& dictionary, int count);

}  // namespace rigproof::detection
