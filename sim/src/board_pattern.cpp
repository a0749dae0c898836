#include "rigproof/sim/board_pattern.h"

#include <opencv2/aruco/dictionary.hpp>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr double kTagGap = 0.3;  // Kalibr's tagSpacing: gap over the tag's side
constexpr int kTagBorder = 2;    // bits; Kalibr's default

// Black cells of a marker, border included, each row in runs.
void add_marker(const cv::aruco::Dictionary& dictionary, int id, int border, const DarkArea& at,
                std::vector<DarkArea>* areas) {
  const int bits = dictionary.markerSize, cells = bits + 2 * border;
  const cv::Mat code = cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.rowRange(id, id + 1), bits);
  const auto is_dark = [&](int x, int y) {
    const bool inside = x >= border && y >= border && x < border + bits && y < border + bits;
    return !inside || code.at<unsigned char>(y - border, x - border) == 0;
  };
  const double cell_x = (at.x1_m - at.x0_m) / cells, cell_y = (at.y1_m - at.y0_m) / cells;
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells;) {
      int end = x;
      while (end < cells && is_dark(end, y)) ++end;
      if (end > x)
        areas->push_back(
            {at.x0_m + x * cell_x, at.y0_m + y * cell_y, at.x0_m + end * cell_x, at.y0_m + (y + 1) * cell_y});
      x = end + 1;
    }
}

// The square in column ix, row iy, shrunk to a share of its side about its middle.
DarkArea cell(const Board& board, int ix, int iy, double share) {
  const double inset = 0.5 * (1.0 - share) * board.square_m;
  const double x = board.square_m * (ix - 1), y = board.square_m * (iy - 1);
  return {x + inset, y + inset, x + board.square_m - inset, y + board.square_m - inset};
}

std::vector<DarkArea> squares(const Board& board) {
  std::vector<DarkArea> areas;
  for (int iy = 0; iy < board.squares_y; ++iy)
    for (int ix = 0; ix < board.squares_x; ++ix)
      if (board.is_dark(ix, iy)) areas.push_back(cell(board, ix, iy, 1.0));
  return areas;
}

cv::Ptr<cv::aruco::Dictionary> codes_of(const Board& board) {
  return cv::aruco::getPredefinedDictionary(dictionary_of(board).number);
}

void add_charuco_markers(const Board& board, std::vector<DarkArea>* areas) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary = codes_of(board);
  const double share = board.marker_side_m() / board.square_m;
  for (const BoardMarker& marker : charuco_markers(board))
    add_marker(*dictionary, marker.id, 1, cell(board, marker.ix, marker.iy, share), areas);
}

std::vector<DarkArea> tags(const Board& board) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary = codes_of(board);
  std::vector<DarkArea> areas;
  int id = 0;
  for (int iy = board.squares_y - 1; iy >= 0; --iy)
    for (int ix = 0; ix < board.squares_x; ++ix)
      add_marker(*dictionary, id++, kTagBorder, cell(board, ix, iy, 1.0 / (1.0 + kTagGap)), &areas);
  const double half = 0.5 * board.square_m * kTagGap / (1.0 + kTagGap);
  for (int iy = 0; iy <= board.squares_y; ++iy)
    for (int ix = 0; ix <= board.squares_x; ++ix) {
      const double x = board.square_m * (ix - 1), y = board.square_m * (iy - 1);
      areas.push_back({x - half, y - half, x + half, y + half});
    }
  return areas;
}

}  // namespace

const std::vector<std::string>& board_types() {
  static const std::vector<std::string> types = {"checkerboard", "charuco", "aprilgrid"};
  return types;
}

std::vector<DarkArea> dark_areas(const Board& board) {
  if (board.type == "aprilgrid") return tags(board);
  if (board.type != "checkerboard" && board.type != "charuco")
    throw Error("board.type: " + board.type + ": must be checkerboard, charuco or aprilgrid");
  std::vector<DarkArea> areas = squares(board);
  if (board.type == "charuco") add_charuco_markers(board, &areas);
  return areas;
}

std::string marker_dictionary(const Board& board) {
  return board.type == "checkerboard" ? std::string() : dictionary_of(board).name;
}

}  // namespace rigproof
