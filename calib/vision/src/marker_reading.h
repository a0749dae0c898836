// Which corners of a ChArUco board or an AprilGrid a grid shows, told by the markers between them.
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

/// What a grid's squares tell of a board.
struct MarkerReading {
  std::optional<MarkedPlacement> placement;  ///< absent where the markers tell no place, or more than one
  double most_evidence = 0.0;                ///< of the likeliest place, sure or not
};

/// Compares what the squares of grids show with all markers of a board, in all four turns: of a ChArUco board the light
/// squares; of an AprilGrid the larger dark ones, with tags of either border, and turned in their places by any right
/// angle, as printers of such grids differ in that.
class MarkerReader {
 public:
  explicit MarkerReader(const Board& board);
  /// Positions of the grid in pixels of the image.
  MarkerReading read(const Image8& grey, const CornerGrid& grid) const;

 private:
  template <typename Take>
  void for_each_border(const Image8& grey, const CornerGrid& grid, const Take& take) const;

  Board board_;
  int bits_;
  std::vector<std::pair<int, std::vector<Eigen::MatrixXf>>> pictures_;  ///< by the width of the border [bits]
};

/// Of a grid whose steps are long and short in turn along both axes, as an AprilGrid's: the long ones over two steps.
std::optional<double> tag_share(const CornerGrid& grid);

}  // namespace rigproof::detection
