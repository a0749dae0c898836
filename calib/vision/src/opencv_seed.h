// A second opinion if our own search finds only part of a board.
#pragma once

#include <optional>

#include "corner_grid.h"

namespace rigproof::detection {

/// OpenCV's findChessboardCorners as a grid; absent if it finds none. Slow on cluttered images (tens of ms), so it is
/// asked only where part of a board was seen.
std::optional<CornerGrid> opencv_corner_grid(const Image8& grey, const Board& board);

}  // namespace rigproof::detection
