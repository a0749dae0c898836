#include "printed_board.h"

#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace rigproof {
namespace {

using Corners = std::map<int, cv::Point2f>;

Corners checkerboard_corners(const Board& board, const cv::Mat& picture) {
  std::vector<cv::Point2f> found;
  const cv::Size size(board.inner_corners_x(), board.inner_corners_y());
  if (!cv::findChessboardCorners(picture, size, found)) return {};
  cv::cornerSubPix(picture, found, {9, 9}, {-1, -1}, {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3});
  // Which of the two ways the rows run is the board's own to tell: its first corner is at the top left here.
  if (found.front().x > found.back().x) std::reverse(found.begin(), found.end());
  Corners corners;
  for (const cv::Point2f& corner : found) corners.emplace(static_cast<int>(corners.size()), corner);
  return corners;
}

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
};
Markers markers(const cv::Mat& picture, int dictionary, int border) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border;
  if (border == 2) parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  Markers found;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(dictionary), found.corners, found.ids,
                           parameters);
  return found;
}

Corners charuco_corners(const Board& board, const cv::Mat& picture) {
  const Markers found = markers(picture, cv::aruco::DICT_5X5_50, 1);
  const auto side = static_cast<float>(board.square_m);
  const auto charuco = cv::aruco::CharucoBoard::create(board.squares_x, board.squares_y, side, 0.75F * side,
                                                       cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_50));
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(found.corners, found.ids, picture, charuco, corners, ids);
  Corners result;
  for (std::size_t i = 0; i < ids.size(); ++i) result[ids[i]] = corners[i];
  return result;
}

Corners tag_corners(const cv::Mat& picture) {
  const Markers found = markers(picture, cv::aruco::DICT_APRILTAG_36h11, 2);
  Corners result;
  for (std::size_t i = 0; i < found.ids.size(); ++i)
    for (int k = 0; k < 4; ++k) result[4 * found.ids[i] + k] = found.corners[i][static_cast<std::size_t>(k)];
  return result;
}

}  // namespace

Board board_of(const std::string& type, int columns, int rows, double square_m) {
  Board board;
  board.type = type;
  board.squares_x = columns;
  board.squares_y = rows;
  board.square_m = square_m;
  return board;
}

std::map<int, cv::Point2f> found_corners(const Board& board, const cv::Mat& picture) {
  if (board.type == "checkerboard") return checkerboard_corners(board, picture);
  return board.type == "charuco" ? charuco_corners(board, picture) : tag_corners(picture);
}

int corners_of(const Board& board) {
  return board.type == "aprilgrid" ? 4 * board.squares_x * board.squares_y : board.corner_count();
}

cv::Point2d corner_m(const Board& board, int number) {
  if (board.type != "aprilgrid") {
    const Eigen::Vector3d corner = board.corner(number);
    return {corner.x() + board.square_m, corner.y() + board.square_m};
  }
  const int id = number / 4, k = number % 4, row = board.squares_y - 1 - id / board.squares_x;
  const double tag = board.square_m / 1.3, inset = 0.5 * (board.square_m - tag);
  return {board.square_m * (id % board.squares_x) + inset + (k == 1 || k == 2 ? tag : 0.0),
          board.square_m * row + inset + (k >= 2 ? tag : 0.0)};
}

void expect_board(const Board& board, const cv::Mat& picture, double pixels_per_mm, double tolerance_mm) {
  const Corners corners = found_corners(board, picture);
  ASSERT_EQ(static_cast<int>(corners.size()), corners_of(board)) << board.type;
  std::map<int, cv::Point2d> off;
  cv::Point2d mean;
  for (const auto& [number, corner] : corners) {
    off[number] = cv::Point2d(corner) / pixels_per_mm - 1000.0 * corner_m(board, number);
    mean += off[number] / static_cast<double>(corners.size());
  }
  for (const auto& [number, shift] : off)
    EXPECT_LT(cv::norm(shift - mean), tolerance_mm) << board.type << ", corner " << number;
}

}  // namespace rigproof
