#include "chessboard.h"

#include <opencv2/calib3d.hpp>

namespace rigproof::detection {

cv::Mat mat_over(const Image8& grey) {
  return {grey.height, grey.width, CV_8UC1, const_cast<std::uint8_t*>(grey.pixels.data())};
}

std::optional<std::vector<cv::Point2f>> find_chessboard(const Image8& grey, const Board& board) {
  std::vector<cv::Point2f> found;
  try {
    const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
    const cv::Size corners(board.inner_corners_x(), board.inner_corners_y());
    if (!cv::findChessboardCorners(mat_over(grey), corners, found, flags)) return std::nullopt;
  } catch (const cv::Exception&) {
    return std::nullopt;  // it asserts on some images
  }
  if (found.size() != static_cast<std::size_t>(board.corner_count())) return std::nullopt;
  return found;
}

}  // namespace rigproof::detection
