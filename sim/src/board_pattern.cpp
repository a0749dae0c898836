#include "rigproof/sim/board_pattern.h"

#include <opencv2/aruco/dictionary.hpp>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr int kTagBorder = 2;     // bits; Kalibr's default
constexpr int kMarkerBorder = 1;  // bits; OpenCV's default

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

// The area in column ix, row iy between corners.
DarkArea area(const Board& board, int ix, int iy) {
  return {board.along(ix - 1), board.along(iy - 1), board.along(ix), board.along(iy)};
}

// The square in column ix, row iy, shrunk to a share of its side about its middle.
DarkArea cell(const Board& board, int ix, int iy, double share) {
  const double inset = 0.5 * (1.0 - share) * board.square_m;
  const double x = board.along(ix - 1), y = board.along(iy - 1);
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
  for (const BoardMarker& marker : markers_of(board))
    add_marker(*dictionary, marker.id, kMarkerBorder, cell(board, marker.ix, marker.iy, share), areas);
}

std::vector<DarkArea> tags(const Board& board) {
  const cv::Ptr<cv::aruco::Dictionary> dictionary = codes_of(board);
  std::vector<DarkArea> areas;
  for (const BoardMarker& tag : markers_of(board))
    add_marker(*dictionary, tag.id, kTagBorder, area(board, tag.ix, tag.iy), &areas);
  for (int iy = 0; iy <= board.inner_corners_y(); iy += 2)
    for (int ix = 0; ix <= board.inner_corners_x(); ix += 2) areas.push_back(area(board, ix, iy));
  return areas;
}

}  // namespace

const std::vector<std::string>& board_types() {
  static const std::vector<std::string> types = {"checkerboard", "charuco", "aprilgrid"};
  return types;
}

std::vector<DarkArea> dark_areas(const Board& board) {
  if (board.has_tags()) return tags(board);
  if (board.type != "checkerboard" && board.type != "charuco")
    throw Error("board.type: " + board.type + ": must be checkerboard, charuco or aprilgrid");
  std::vector<DarkArea> areas = squares(board);
  if (board.type == "charuco") add_charuco_markers(board, &areas);
  return areas;
}

double finest_detail_m(const Board& board) {
  if (board.type == "checkerboard") return board.square_m;
  const int border = board.has_tags() ? kTagBorder : kMarkerBorder;
  return board.marker_side_m() / (dictionary_of(board).bits + 2 * border);
}

std::string marker_dictionary(const Board& board) {
  return board.type == "checkerboard" ? std::string() : dictionary_of(board).name;
}

}  // namespace rigproof
