// Which markers a board has, and where.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

/// One of OpenCV's predefined dictionaries.
struct MarkerDictionary {
  const char* name;  ///< as OpenCV calls it: "DICT_5X5_50"
  int number;        ///< OpenCV's, of cv::aruco::getPredefinedDictionary
  int bits;          ///< along a side, without the border
  int markers;       ///< that it has
};

/// All of them; the first of each size of markers is part of its others.
const std::vector<MarkerDictionary>& marker_dictionaries();

/// The dictionary of a ChArUco board or AprilGrid. Throws Error where it is unknown or has too few markers.
const MarkerDictionary& dictionary_of(const Board& board);

/// Why a board cannot have its markers: no such dictionary, too few of them; nothing for a board without markers.
std::optional<std::string> problem_of_markers(const Board& board);

/// Why an image may show either of two boards; nothing where their markers tell.
std::optional<std::string> problem_of_telling_apart(const Board& a, const Board& b);

/// A marker's id, and the area between corners that it is in (column, row; as Board::is_dark()).
struct BoardMarker {
  int id, ix, iy;
};

/// ChArUco board: one in each light square, ids along the rows from the first one. AprilGrid: its tags, ids from the
/// cell at -x +y along the rows, as Kalibr counts. Empty for other boards.
std::vector<BoardMarker> markers_of(const Board& board);

/// From where the squares begin, or the cells of an AprilGrid, to corner 0 along either axis [m].
double first_corner_m(const Board& board);
/// By how much an AprilGrid's small squares reach beyond its cells [m]; 0 for other boards.
double overhang_m(const Board& board);

}  // namespace rigproof
