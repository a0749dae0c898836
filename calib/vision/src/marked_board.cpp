#include "rigproof/calib/vision/marked_board.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "board_fit.h"
#include "board_search.h"
#include "chessboard.h"
#include "marker_reading.h"
#include "rigproof/calib/geometry/homography.h"
#include "smooth_image.h"

namespace rigproof {
namespace {

using detection::BoardFit;
using detection::BoardPlacement;
using detection::CornerGrid;
using detection::MarkedPlacement;
using detection::Pyramid;
using Eigen::Vector2d;

constexpr int kMinImageSize = 32;
constexpr std::size_t kMinGrid = 4;
// Texture and markers chain saddles, too; the board's grids are among the largest.
constexpr std::size_t kGridsRead = 16;
// Of the markers of a board over those of any other board that the image may show.
constexpr double kAheadOfOthers = 6.0;

/// A part of an image, enlarged.
struct Enlarged {
  Image8 image;
  Vector2d origin;  ///< of the part, in pixels of the whole
  double factor;

  Vector2d in_whole(const Vector2d& pixel) const {
    return ((pixel.array() + 0.5) / factor - 0.5).matrix() + origin;  // pixel centres are integers
  }
};

// For small squares, whose markers are too near to their corners for the search.
Enlarged enlarge(const Image8& grey, const cv::Rect& part, int factor) {
  Enlarged result{Image8(factor * part.width, factor * part.height), Vector2d(part.x, part.y),
                  static_cast<double>(factor)};
  cv::Mat to = detection::mat_over(result.image);
  cv::resize(detection::mat_over(grey)(part), to, to.size(), 0.0, 0.0, cv::INTER_CUBIC);
  return result;
}

std::vector<CornerGrid> grids_of(const Enlarged& part) {
  Pyramid pyramid(part.image);
  std::vector<CornerGrid> grids = detection::search_grids(pyramid, 0, kMinGrid);
  for (CornerGrid& grid : grids)
    for (auto& [at, position] : grid.corners) position = part.in_whole(position);
  return grids;
}

Eigen::AlignedBox2d box_of(const CornerGrid& grid) {
  Eigen::AlignedBox2d box;
  for (const auto& [at, position] : grid.corners) box.extend(position);
  return box;
}

// Around a grid, with as much on each side as it is large, or as so many pixels.
cv::Rect surroundings(const CornerGrid& grid, const Image8& grey, double least_px) {
  const Eigen::AlignedBox2d box = box_of(grid);
  const Vector2d more = box.sizes().cwiseMax(least_px);
  const Vector2d low = box.min() - more, high = box.max() + more;
  const cv::Rect around(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>((high - low).x()),
                        static_cast<int>((high - low).y()));
  return around & cv::Rect(0, 0, grey.width, grey.height);
}

// A lens bends a board by less than this from where a plane's corners are expected [as place_of_corner()].
constexpr double kOffPlane = 0.3;

std::optional<detection::Homography> homography_of(const BoardPlacement& placement, const Board& board) {
  std::vector<detection::PlanePoint> points;
  for (const auto& [id, pixel] : placement.seeds) points.push_back({detection::place_of_corner(board, id), pixel});
  return detection::Homography::fit(points);
}

// Without corners of markers that were joined to the grid.
BoardPlacement on_one_plane(BoardPlacement placement, const Board& board) {
  std::vector<cv::Point2d> pixels, places;
  for (const auto& [id, pixel] : placement.seeds) {
    const Vector2d place = detection::place_of_corner(board, id);
    pixels.emplace_back(pixel.x(), pixel.y());
    places.emplace_back(place.x(), place.y());
  }
  std::vector<unsigned char> on_plane;
  if (pixels.size() > 4) cv::findHomography(pixels, places, cv::RANSAC, kOffPlane, on_plane);
  if (on_plane.size() != pixels.size()) return placement;
  BoardPlacement kept;
  kept.tag_border_bits = placement.tag_border_bits;
  for (std::size_t i = 0; i < on_plane.size(); ++i)
    if (on_plane[i] != 0) kept.seeds.push_back(placement.seeds[i]);
  return kept.seeds.size() >= 4 ? kept : placement;
}

// Two searches find a corner within so much [px].
constexpr double kSameCorner = 1.5;

bool has_corner_at(const CornerGrid& grid, const Vector2d& pixel) {
  return std::any_of(grid.corners.begin(), grid.corners.end(),
                     [&pixel](const auto& corner) { return (corner.second - pixel).norm() < kSameCorner; });
}

// Mean distance of neighbours along the axis along which it is shorter [px].
double square_of(const CornerGrid& grid) {
  std::array<double, 2> sum{}, count{};
  for (const auto& [at, pixel] : grid.corners)
    for (const auto& [axis, next] :
         {std::pair(0, std::pair(at.first + 1, at.second)), {1, {at.first, at.second + 1}}}) {
      const auto found = grid.corners.find(next);
      if (found == grid.corners.end()) continue;
      sum[static_cast<std::size_t>(axis)] += (found->second - pixel).norm();
      ++count[static_cast<std::size_t>(axis)];
    }
  return std::min(sum[0] / std::max(count[0], 1.0), sum[1] / std::max(count[1], 1.0));
}

/// A grid that does not show the board, or not for sure.
struct UnreadGrid {
  CornerGrid grid;
  double evidence;  ///< of where the board would be likeliest
};

/// Looks level by level for grids whose markers tell where they lie on the board.
class MarkedBoardFinder {
 public:
  MarkedBoardFinder(const Image8& grey, const Board& board, const CheckerboardOptions& options)
      : grey_(grey), board_(board), options_(options), reader_(board) {}

  BoardDetection find() {
    Pyramid pyramid(grey_);
    for (const std::size_t level : pyramid.search_order()) {
      read(detection::search_grids(pyramid, level, kMinGrid));
      if (is_whole()) break;
    }
    if (!is_whole()) look_closer();
    if (parts_.empty()) return BoardNotFound{why_unread()};
    BoardFit fit = fit_board(grey_, board_, joined(), options_);
    if (fit.corners.empty()) return BoardNotFound{fit.why_not.value_or(Finding("board.not_found"))};
    return std::move(fit.corners);
  }

 private:
  // At twice the size, and where that shows grids of small squares, at four times.
  void look_closer() {
    constexpr int kMaxDoubled = 2048;
    constexpr double kFar_px = 40.0;
    if (std::max(grey_.width, grey_.height) > kMaxDoubled) return;
    const std::vector<CornerGrid> grids = grids_of(enlarge(grey_, cv::Rect(0, 0, grey_.width, grey_.height), 2));
    read(grids);
    look_around(grids, 0.0);
    if (!parts_.empty()) return;
    // Of a board that is seen from afar and aslant a few corners may be all that a grid holds.
    look_around(grids, kFar_px);
    parts_.erase(std::remove_if(parts_.begin(), parts_.end(), [this](const auto& part) { return is_refuted(part); }),
                 parts_.end());
  }
  void look_around(const std::vector<CornerGrid>& grids, double least_px) {
    constexpr int kMaxPart = 480, kLeastPart = 8;
    constexpr std::size_t kGridsEnlarged = 8;
    std::vector<cv::Rect> looked_at;
    for (std::size_t i = 0; i < std::min(grids.size(), kGridsEnlarged) && !is_whole(); ++i) {
      const cv::Rect part = surroundings(grids[i], grey_, least_px);
      if (std::max(part.width, part.height) > kMaxPart || std::min(part.width, part.height) < kLeastPart) continue;
      const bool seen = std::any_of(looked_at.begin(), looked_at.end(),
                                    [&part](const cv::Rect& rect) { return (rect & part) == part; });
      if (seen) continue;
      looked_at.push_back(part);
      read(grids_of(enlarge(grey_, part, 4)));
    }
  }

  void read(const std::vector<CornerGrid>& grids) {
    for (std::size_t i = 0; i < std::min(grids.size(), kGridsRead); ++i) {
      auto [part, evidence] = reader_.read(grey_, grids[i]);
      if (part && !may_be_another(*part, grids[i]))
        parts_.push_back(std::move(*part));
      else
        unread_.push_back({grids[i], evidence});
    }
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const MarkedPlacement& a, const MarkedPlacement& b) { return a.evidence > b.evidence; });
  }
  // Markers that are too small to be read look like others by chance.
  bool may_be_another(const MarkedPlacement& part, const CornerGrid& grid) {
    if (others_.empty())
      for (const Board& other : options_.others) others_.emplace_back(other);
    return std::any_of(others_.begin(), others_.end(), [&](const detection::MarkerReader& other) {
      return other.read(grey_, grid).most_evidence > part.evidence - kAheadOfOthers;
    });
  }
  // A few markers of another board may lie to each other as on this one: then a larger grid, of which theirs is part,
  // could not be read.
  bool is_refuted(const MarkedPlacement& part) const {
    constexpr std::size_t kShared = 3;
    const auto& seeds = part.placement.seeds;
    return std::any_of(unread_.begin(), unread_.end(), [&seeds](const UnreadGrid& unread) {
      const CornerGrid& grid = unread.grid;
      if (grid.corners.size() <= seeds.size()) return false;
      const auto is_shared = [&grid](const auto& seed) { return has_corner_at(grid, seed.second); };
      return static_cast<std::size_t>(std::count_if(seeds.begin(), seeds.end(), is_shared)) >= kShared;
    });
  }
  // Squares that look as the board's would, but have cells too small to be sure of, are no missing board. What chance
  // shows has evidence of up to 12.
  Finding why_unread() const {
    constexpr double kLegible_px = 1.5, kNotByChance = 20.0;
    for (const auto& [grid, evidence] : unread_) {
      if (board_.type != "charuco" || evidence < kNotByChance) continue;
      const double cell_px = detection::marker_cell_px(board_, square_of(grid));
      if (cell_px < kLegible_px) return Finding("board.markers_too_small", {{"cell_px", cell_px}});
    }
    return Finding("board.not_found");
  }
  bool is_whole() const {
    return !parts_.empty() && parts_.front().placement.seeds.size() == static_cast<std::size_t>(board_.corner_count());
  }

  // The likeliest part, and of the others what lies where it expects them: something hid what is between, or only one
  // size of the image showed them.
  BoardPlacement joined() const {
    BoardPlacement all = on_one_plane(parts_.front().placement, board_);
    std::set<int> ids;
    for (const auto& seed : all.seeds) ids.insert(seed.first);
    const std::optional<detection::Homography> H = homography_of(all, board_);
    if (!H) return all;
    for (std::size_t k = 1; k < parts_.size(); ++k)
      for (const auto& [id, pixel] : parts_[k].placement.seeds) {
        Vector2d place;
        if (!H->unmap(pixel, &place) || (place - detection::place_of_corner(board_, id)).norm() > kOffPlane) continue;
        if (ids.insert(id).second) all.seeds.emplace_back(id, pixel);
      }
    std::sort(all.seeds.begin(), all.seeds.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return on_one_plane(std::move(all), board_);
  }

  const Image8& grey_;
  const Board& board_;
  const CheckerboardOptions& options_;
  detection::MarkerReader reader_;
  std::vector<detection::MarkerReader> others_;  ///< made when a board is found
  std::vector<MarkedPlacement> parts_;           ///< likeliest first
  std::vector<UnreadGrid> unread_;
};

}  // namespace

BoardDetection detect_by_markers(const Image8& image, const Board& board, const CheckerboardOptions& options) {
  if (board.inner_corners_x() < 2 || board.inner_corners_y() < 2)
    return BoardNotFound{Finding("board.too_few_squares")};
  if (std::min(image.width, image.height) < kMinImageSize) return BoardNotFound{Finding("image.too_small")};
  if (image.channels == 1) return MarkedBoardFinder(image, board, options).find();
  return MarkedBoardFinder(detection::to_grey(image), board, options).find();
}

BoardDetection detect_board(const Image8& image, const Board& board, const CheckerboardOptions& options) {
  return board.type == "checkerboard" ? detect_checkerboard(image, board, options)
                                      : detect_by_markers(image, board, options);
}

}  // namespace rigproof
