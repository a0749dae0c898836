#include "opencv_seed.h"

#include <algorithm>
#include <array>

#include "chessboard.h"

namespace rigproof::detection {
namespace {

using Eigen::Vector2d;

// Mean grey value of a square's middle, from its four corners.
double grey_of_square(const Image8& grey, const std::array<Vector2d, 4>& corners) {
  const Vector2d centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const int x = std::clamp(static_cast<int>(centre.x()), 0, grey.width - 1);
  const int y = std::clamp(static_cast<int>(centre.y()), 0, grey.height - 1);
  return grey.at(x, y);
}

// True if the squares with even i + j are the dark ones.
bool even_squares_are_dark(const Image8& grey, const CornerGrid& grid) {
  double even_minus_odd = 0.0;
  for (int i = 0; i < grid.i_max; ++i) {
    for (int j = 0; j < grid.j_max; ++j) {
      const double value = grey_of_square(grey, {grid.corners.at({i, j}), grid.corners.at({i + 1, j}),
                                                 grid.corners.at({i, j + 1}), grid.corners.at({i + 1, j + 1})});
      even_minus_odd += (i + j) % 2 == 0 ? value : -value;
    }
  }
  return even_minus_odd < 0.0;
}

}  // namespace

std::optional<CornerGrid> opencv_corner_grid(const Image8& grey, const Board& board) {
  const int columns = board.inner_corners_x(), rows = board.inner_corners_y();
  const auto chessboard = find_chessboard(grey, board);
  if (!chessboard) return std::nullopt;
  const std::vector<cv::Point2f>& found = *chessboard;
  const cv::Point2f along = found[1] - found[0], down = found[static_cast<std::size_t>(columns)] - found[0];
  const bool clockwise = along.x * down.y - along.y * down.x > 0.0F;
  CornerGrid grid;
  for (int k = 0; k < board.corner_count(); ++k) {
    const int i = clockwise ? k % columns : columns - 1 - k % columns;
    const cv::Point2f& p = found[static_cast<std::size_t>(k)];
    grid.corners[{i, k / columns}] = Vector2d(p.x, p.y);
  }
  grid.i_max = columns - 1;
  grid.j_max = rows - 1;
  grid.first_square_dark = even_squares_are_dark(grey, grid);
  return grid;
}

}  // namespace rigproof::detection
