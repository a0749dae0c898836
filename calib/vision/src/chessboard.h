// OpenCV's search for a checkerboard.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"

namespace rigproof::detection {

/// A view on the image's pixels, which must outlive it.
cv::Mat mat_over(const Image8& grey);

/// findChessboardCorners with adaptive threshold, normalisation and fast check: all corners, rows of
/// inner_corners_x(), to about a pixel. Which corner is the first one is OpenCV's choice.
std::optional<std::vector<cv::Point2f>> find_chessboard(const Image8& grey, const Board& board);

}  // namespace rigproof::detection
