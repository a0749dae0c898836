// What is printed on a board: its dark areas, of checkerboards, ChArUco boards and AprilGrids.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

/// A dark area [board frame, m].
struct DarkArea {
  double x0_m, y0_m, x1_m, y1_m;
};

/// "checkerboard", "charuco", "aprilgrid".
const std::vector<std::string>& board_types();

/// All dark areas of a board, by its type:
/// - checkerboard: its dark squares, the first one outside of corner 0;
/// - charuco: the same, and in every light square an ArUco marker (core/board_markers.h);
/// - aprilgrid: tags 36h11 of OpenCV's dictionary, a border of two bits, one a cell of the size of a square; ids from
/// the
///   bottom left along the rows; and a small dark square where cells meet, as Kalibr prints them.
/// Throws Error where there are not enough markers, or for an unknown type.
std::vector<DarkArea> dark_areas(const Board& board);

/// The side of the smallest squares that are printed: of a marker's cells, or the board's squares [m].
double finest_detail_m(const Board& board);

/// The dictionary of the board's markers, as OpenCV calls it: "DICT_5X5_50"; empty for a checkerboard.
std::string marker_dictionary(const Board& board);

}  // namespace rigproof
