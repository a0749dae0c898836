// Which corners of a ChArUco board a grid shows, told by the markers in its light squares.
#pragma once

#include <optional>
#include <vector>

#include "corner_grid.h"
#include "rigproof/core/board.h"
#include "rigproof/core/image.h"

namespace rigproof::detection {

/// How a board lies in a grid.
struct MarkedPlacement {
  BoardPlacement placement;
  double evidence = 0.0;  ///< logarithm of how much likelier these markers are than any picture
};

/// Compares what the light squares of grids show with all markers of a board, in all four turns.
class MarkerReader {
 public:
  explicit MarkerReader(const Board& board);
  /// Positions of the grid in pixels of the image. Absent where the markers tell no place, or more than one.
  std::optional<MarkedPlacement> read(const Image8& grey, const CornerGrid& grid) const;

 private:
  Board board_;
  int bits_;
  std::vector<Eigen::MatrixXf> pictures_;
};

}  // namespace rigproof::detection
