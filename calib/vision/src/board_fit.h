// From seeds of a board's corners to measured corners.
#pragma once

#include <optional>

#include "corner_grid.h"
#include "rigproof/calib/vision/checkerboard.h"

namespace rigproof::detection {

struct BoardFit {
  std::vector<CornerObservation> corners;  ///< in the order of ids; empty if the board was not measured
  std::optional<Finding> why_not;          ///< why it is empty
  int outside = 0;                         ///< corners that lie outside of the image
  int fitted = 0;                          ///< corners that were measured, also of a board that is not taken
};

/// Where a corner lies on its board from corner 0, in squares; on an AprilGrid in mean distances of its corners.
Eigen::Vector2d place_of_corner(const Board& board, int id);

/// A side of the cells of a ChArUco board's markers, by that of its squares [px].
double marker_cell_px(const Board& board, double square_px);

/// Fits every corner twice: first in windows from the seeds' homography, then from that of the fitted corners.
BoardFit fit_board(const Image8& grey, const Board& board, const BoardPlacement& placement,
                   const CheckerboardOptions& options);

}  // namespace rigproof::detection
