// The corners that the authors' program of MEMROC finds in images.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/calib/vision/image_files.h"
#include "rigproof/core/board.h"
#include "rigproof/core/image.h"

namespace rigproof::rivals {

/// All corners of a checkerboard: the i-th is corner i of the board, whose first one is OpenCV's choice.
struct ChessboardCorners {
  std::vector<Eigen::Vector2f> pixels;
};

/// OpenCV's findChessboardCorners (adaptive threshold, normalised, fast check), then cornerSubPix (11 x 11 either way,
/// at most 30 iterations, down to 0.1 px). Absent where it does not find all corners.
std::optional<ChessboardCorners> reference_corners(const Image8& grey, const Board& board);

/// By (stop, camera): what reference_corners() finds in each frame's image. Images that cannot be read are left out.
/// In parallel, with the input's progress and memory; throws Error with ExitCode::kTryAgain if it is interrupted.
using ChessboardViews = std::map<std::pair<int, int>, std::optional<ChessboardCorners>>;
ChessboardViews reference_chessboards(const MethodInput& input, const FramesByStop& frames);

}  // namespace rigproof::rivals
