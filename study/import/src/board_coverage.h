// How often each camera of a recording sees the board.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct BoardCoverage {
  std::vector<std::size_t> stops;      ///< [camera] stops at which the whole board was found
  std::vector<std::size_t> looked_at;  ///< [camera] stops that were looked at
  std::optional<std::string>
      seen;  ///< the board that most images show: "type: checkerboard, squares: [5, 4], square_mm: 100"
};

/// Called with images looked at and in all; false interrupts.
using CoverageProgress = std::function<bool(std::uint64_t, std::uint64_t)>;

/// The board in an image, a ChArUco board or a checkerboard of whatever size; its squares' side means nothing.
std::optional<Board> any_board(const Image8& image);

/// The board that the recording's rig states, at every stop.
BoardCoverage find_board(const Recording& recording, int threads, const CoverageProgress& progress);
/// Any checkerboard, in some images of each camera: which one it may be.
BoardCoverage guess_board(const Recording& recording, const CoverageProgress& progress);

}  // namespace rigproof
