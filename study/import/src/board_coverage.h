// How often each camera of a recording sees the board.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct BoardCoverage {
  std::vector<std::size_t> stops;      ///< [camera] stops at which the whole board was found
  std::vector<std::size_t> cells;      ///< [camera] of kImageCells, those with a corner in them; empty: a board guessed
  std::vector<std::size_t> looked_at;  ///< [camera] stops that were looked at
  /// The board that most corners speak for, and others beside it that images tell from it, by their markers; their
  /// squares' side means nothing.
  std::vector<Board> boards;
  std::vector<std::string> seen;  ///< the same as rig.yaml says it: "type: checkerboard, squares: [5, 4], ..: 100"
  std::string problem;            ///< why it could not be looked for, and the rest is empty
};

/// Called with images looked at and in all; false interrupts.
using CoverageProgress = std::function<bool(std::uint64_t, std::uint64_t)>;

/// The board in an image, a ChArUco board or a checkerboard of whatever size; its squares' side means nothing.
std::optional<Board> any_board(const Image8& image);

/// The boards that the recording's rig states, at every stop.
BoardCoverage cover_board(const Recording& recording, int threads, const CoverageProgress& progress);
/// The same, and other boards in some images of each camera.
BoardCoverage find_board(const Recording& recording, int threads, const CoverageProgress& progress);
/// Any boards, in some images of each camera: which ones they may be.
BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress);

}  // namespace rigproof
