// Boards, and what OpenCV's detectors find on a picture of one.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "rigproof/core/board.h"

namespace rigproof {

Board board_of(const std::string& type, int columns, int rows, double square_m);

/// Corners on a picture [px], by the number that each has on its board: of checkerboards and ChArUco boards the inner
/// corners, of AprilGrids four times a tag's number and 0 to 3, clockwise from its top left.
std::map<int, cv::Point2f> found_corners(const Board& board, const cv::Mat& picture);
/// Where the same corners are, from the upper left corner of the first square [m].
cv::Point2d corner_m(const Board& board, int number);
/// How many there are.
int corners_of(const Board& board);

/// All are found, in their places: worse than `tolerance_mm` is none after the best shift. Pictures of so many pixels a
/// millimetre.
void expect_board(const Board& board, const cv::Mat& picture, double pixels_per_mm, double tolerance_mm);

}  // namespace rigproof
