// Finds a ChArUco board, also a part of it, and measures its inner corners as a checkerboard's.
#pragma once

#include "rigproof/calib/vision/checkerboard.h"

namespace rigproof {

/// Detects the board in an 8-bit grey or RGB image. The markers tell which corners are seen, so that some are enough:
/// at least six, in at least two rows and columns. Corners come in the order of their ids, each with its covariance; a
/// hidden or spoilt one is missing. Never throws on image content; Error where the board cannot have its markers.
BoardDetection detect_charuco(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

/// The ChArUco board in the image, whatever its size and dictionary, down to the last row of which a marker is seen;
/// its squares have a side of 1, the markers' side is good to some hundredths. Tells what a rig.yaml should say. Never
/// throws on image content.
std::optional<Board> find_any_charuco(const Image8& image);

/// Whether boards of a type are detected: checkerboards and ChArUco boards.
bool can_be_detected(const Board& board);

/// By the type of the board.
BoardDetection detect_board(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

}  // namespace rigproof
