#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <utility>

#include "board_search.h"
#include "chessboard.h"
#include "marker_reading.h"
#include "rigproof/calib/geometry/homography.h"
#include "rigproof/calib/vision/marked_board.h"
#include "rigproof/core/board_markers.h"
#include "smooth_image.h"

namespace rigproof {
namespace {

using detection::Homography;
using detection::PlanePoint;
using Eigen::Vector2d;

constexpr std::size_t kLeastMarkers = 4;
constexpr int kMostColumns = 30;

struct FoundMarker {
  int id;
  std::array<Vector2d, 4> corners;

  Vector2d middle() const { return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]); }
};

struct FoundMarkers {
  const MarkerDictionary* dictionary = nullptr;  ///< the largest of its codes
  std::vector<FoundMarker> markers;
};

std::vector<FoundMarker> find_markers(const Image8& grey, const MarkerDictionary& dictionary) {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  try {
    cv::aruco::detectMarkers(detection::mat_over(grey), cv::aruco::getPredefinedDictionary(dictionary.number), corners,
                             ids);
  } catch (const cv::Exception&) {
    return {};  // it asserts on some images
  }
  std::vector<FoundMarker> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    FoundMarker marker{ids[i], {}};
    for (std::size_t k = 0; k < 4; ++k) marker.corners[k] = Vector2d(corners[i][k].x, corners[i][k].y);
    found.push_back(marker);
  }
  return found;
}

// Of the codes of any dictionary those of which most are seen.
FoundMarkers most_markers(const Image8& grey) {
  FoundMarkers most;
  const std::vector<MarkerDictionary>& all = marker_dictionaries();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool continued = i + 1 < all.size() && i < 15 && all[i + 1].bits == all[i].bits;
    if (continued) continue;  // the next one has these codes, too
    std::vector<FoundMarker> found = find_markers(grey, all[i]);
    if (found.size() > most.markers.size()) most = {&all[i], std::move(found)};
  }
  return most;
}

// Of dictionaries with the same codes the smallest one that has an id.
const MarkerDictionary& smallest_with(const MarkerDictionary& largest, int id) {
  const std::vector<MarkerDictionary>& all = marker_dictionaries();
  const MarkerDictionary* smallest = &largest;
  for (const MarkerDictionary& one : all)
    if (largest.number < 16 && one.number < 16 && one.bits == largest.bits && one.markers > id &&
        one.markers < smallest->markers)
      smallest = &one;
  return *smallest;
}

/// A number of columns under which the ids lie as they are seen.
struct Layout {
  Board board;
  double squared_px = 0.0;  ///< mean distance of the markers' middles
  std::optional<Homography> H;
};

// The board with this many columns and enough rows for the markers, and how well it explains where they are.
Layout layout_of(const std::vector<FoundMarker>& found, int columns, bool first_light) {
  Layout layout;
  layout.board.type = "charuco";
  layout.board.squares_x = columns;
  layout.board.square_m = 1.0;
  layout.board.legacy_pattern = first_light;
  layout.board.squares_y = 2 * (found.back().id / columns + 2);  // even: the legacy pattern shows
  const std::vector<BoardMarker> markers = markers_of(layout.board);
  std::vector<PlanePoint> points;
  for (const FoundMarker& one : found) {
    const BoardMarker& marker = markers[static_cast<std::size_t>(one.id)];
    points.push_back({Vector2d(marker.ix, marker.iy), one.middle()});
  }
  layout.H = Homography::fit(points);
  if (!layout.H) return layout;
  for (const PlanePoint& point : points) {
    Vector2d place = Vector2d::Constant(1e6);
    layout.H->map(point.board, &place);
    layout.squared_px += (place - point.pixel).squaredNorm() / static_cast<double>(points.size());
  }
  layout.board.squares_y = markers[static_cast<std::size_t>(found.back().id)].iy + 1;
  if (layout.board.squares_y % 2 == 1 && first_light) layout.H.reset();  // no such board is drawn
  return layout;
}

// Side of the markers over that of the squares, in steps of a hundredth.
double marker_share(const std::vector<FoundMarker>& found, const Homography& H) {
  double sum = 0.0;
  for (const FoundMarker& one : found)
    for (std::size_t k = 0; k < 4; ++k) {
      Vector2d a = Vector2d::Zero(), b = Vector2d::Zero();
      if (H.unmap(one.corners[k], &a) && H.unmap(one.corners[(k + 1) % 4], &b)) sum += 0.25 * (b - a).norm();
    }
  return std::clamp(0.01 * std::round(100.0 * sum / static_cast<double>(found.size())), 0.05, 0.95);
}

std::optional<Board> find_any_charuco(const Image8& grey) {
  constexpr double kWorst_px2 = 25.0;
  FoundMarkers seen = most_markers(grey);
  std::vector<FoundMarker>& found = seen.markers;
  if (found.size() < kLeastMarkers) return std::nullopt;
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  Layout best;
  for (int columns = 3; columns <= kMostColumns; ++columns)
    for (const bool first_light : {false, true}) {
      Layout layout = layout_of(found, columns, first_light);
      if (layout.H && (!best.H || layout.squared_px < best.squared_px)) best = std::move(layout);
    }
  if (!best.H || best.squared_px > kWorst_px2 || best.board.squares_y < 3) return std::nullopt;
  best.board.marker_m = marker_share(found, *best.H);
  best.board.dictionary = smallest_with(*seen.dictionary, static_cast<int>(markers_of(best.board).size()) - 1).name;
  return best.board;
}

// The AprilGrid with this many columns as far as a grid shows it, and what speaks for it. Ids count from the lowest
// row, so that rows above those that are seen change nothing.
std::optional<std::pair<double, Board>> aprilgrid_in(const Image8& grey, const detection::CornerGrid& grid, double tag,
                                                     int columns) {
  constexpr int kTags = 587;
  Board board;
  board.type = "aprilgrid";
  board.squares_x = columns;
  board.squares_y = std::min(kMostColumns, kTags / columns);
  board.square_m = 1.0;
  board.marker_m = tag;
  const auto read = detection::MarkerReader(board).read(grey, grid).placement;
  if (!read) return std::nullopt;
  const int highest = read->placement.seeds.front().first / board.inner_corners_x();  // ids run along the rows
  board.squares_y -= highest / 2;
  return std::pair(read->evidence, board);
}

std::optional<Board> find_any_aprilgrid(const Image8& grey) {
  constexpr std::size_t kLeastCorners = 16, kGridsTried = 3;
  std::optional<std::pair<double, Board>> best;
  detection::Pyramid pyramid(grey);
  for (const std::size_t level : pyramid.search_order()) {
    const std::vector<detection::CornerGrid> grids = detection::search_grids(pyramid, level, kLeastCorners);
    for (std::size_t i = 0; i < std::min(grids.size(), kGridsTried); ++i) {
      const std::optional<double> tag = detection::tag_share(grids[i]);
      for (int columns = 3; tag && columns <= kMostColumns; ++columns) {
        auto one = aprilgrid_in(grey, grids[i], *tag, columns);
        if (one && (!best || one->first > best->first)) best = std::move(one);
      }
    }
    if (best) break;
  }
  if (!best) return std::nullopt;
  best->second.marker_m = 0.01 * std::round(100.0 * *best->second.marker_m);
  return best->second;
}

}  // namespace

std::optional<Board> find_any_marked_board(const Image8& image) {
  if (std::min(image.width, image.height) < 32) return std::nullopt;
  const Image8 grey = detection::to_grey(image);
  if (std::optional<Board> grid = find_any_aprilgrid(grey)) return grid;
  return find_any_charuco(grey);
}

}  // namespace rigproof
