// Finds boards with markers, also a part of them, and measures their corners as a checkerboard's.
#pragma once

#include "rigproof/calib/vision/checkerboard.h"

namespace rigproof {

/// Detects a ChArUco board or an AprilGrid in an 8-bit grey or RGB image. The markers tell which corners are seen, so
/// that some are enough: at least six, in at least two rows and columns. Corners come in the order of their ids, each
/// with its covariance; a hidden or spoilt one is missing. Never throws on image content; Error where the board cannot
/// have its markers.
BoardDetection detect_by_markers(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

/// The ChArUco board or AprilGrid in the image, whatever its size and dictionary, as far as the last row of which a
/// marker is seen; its squares have a side of 1, the markers' side is good to some hundredths. Tells what a rig.yaml
/// should say. Never throws on image content.
std::optional<Board> find_any_marked_board(const Image8& image);

/// By the type of the board.
BoardDetection detect_board(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

}  // namespace rigproof
