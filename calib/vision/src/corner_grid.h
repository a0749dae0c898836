// Saddles joined along the edges between squares into grids.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "rigproof/core/board.h"
#include "saddle_candidates.h"

namespace rigproof::detection {

/// Connected corners, at integer coordinates (i, j); j's axis is clockwise of i's in the image.
struct CornerGrid {
  std::map<std::pair<int, int>, Eigen::Vector2d> corners;  ///< positions in pixels of the level
  /// True if the square between (0, 0) and (1, 1) is dark; colours alternate.
  bool first_square_dark = false;
  int i_min = 0, i_max = 0, j_min = 0, j_max = 0;

  int extent_i() const { return i_max - i_min + 1; }
  int extent_j() const { return j_max - j_min + 1; }
  bool is_full() const {
    return corners.size() == static_cast<std::size_t>(extent_i()) * static_cast<std::size_t>(extent_j());
  }
  bool is_dark(int i, int j) const { return first_square_dark == ((i + j) % 2 == 0); }
};

/// All grids of at least `min_corners` corners, largest first.
std::vector<CornerGrid> grow_corner_grids(const SmoothImage& image, const std::vector<SaddleCandidate>& candidates,
                                          std::size_t min_corners);

/// Where a board may lie in a grid: seeds[id] is present where the grid has that corner.
struct BoardPlacement {
  std::vector<std::pair<int, Eigen::Vector2d>> seeds;  ///< (corner id, position)
  int tag_border_bits = 2;                             ///< of an AprilGrid: how wide its tags' borders are
};

/// The placements of the board in the grid, mirrored ones and wrongly coloured ones excluded, that hold the largest
/// number of corners.
std::vector<BoardPlacement> place_board(const CornerGrid& grid, const Board& board);

}  // namespace rigproof::detection
