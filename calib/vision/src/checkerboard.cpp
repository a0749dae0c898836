#include "rigproof/calib/vision/checkerboard.h"

#include <algorithm>
#include <limits>

#include "board_fit.h"
#include "board_search.h"
#include "rigproof/calib/geometry/homography.h"
#include "rigproof/core/median.h"
#include "smooth_image.h"

namespace rigproof {
namespace {

using detection::BoardFit;
using detection::BoardHypothesis;
using detection::BoardPlacement;
using detection::CornerGrid;
using detection::Pyramid;
using Eigen::Vector2d;

constexpr int kMinImageSize = 32;
// Part of the corners that makes it worthwhile to look closer, and to call it a board in the reason.
constexpr double kPartOfBoard = 0.4;
// Equally good placements beyond this number come from texture, not from a board.
constexpr std::size_t kMaxPlacements = 8;

std::string size_text(int a, int b) { return std::to_string(std::max(a, b)) + "x" + std::to_string(std::min(a, b)); }

// How far the board's x axis points to the right in the image.
double rightward(const Board& board, const BoardPlacement& placement) {
  Vector2d sum = Vector2d::Zero();
  double weight = 0.0;
  const double middle = 0.5 * (board.inner_corners_x() - 1);
  for (const auto& [id, pixel] : placement.seeds) {
    const double x = id % board.inner_corners_x() - middle;
    sum += x * pixel;
    weight += x * x;
  }
  const Vector2d along = sum / std::max(weight, 1.0);
  return along.x() + 1e-9 * along.y();
}

// Of the rotations under which a symmetric board looks the same, the upright one.
void keep_upright(const Board& board, std::vector<BoardPlacement>* placements) {
  const auto best = std::max_element(placements->begin(), placements->end(), [&board](const auto& a, const auto& b) {
    return rightward(board, a) < rightward(board, b);
  });
  *placements = {*best};
}

// Placements that differ in which squares they cover, not only in rotation.
bool cover_the_same(const std::vector<BoardPlacement>& placements) {
  const auto centre = [](const BoardPlacement& placement) {
    Vector2d sum = Vector2d::Zero();
    for (const auto& seed : placement.seeds) sum += seed.second;
    return Vector2d(sum / static_cast<double>(placement.seeds.size()));
  };
  const Vector2d first = centre(placements.front());
  return std::all_of(placements.begin(), placements.end(),
                     [&](const auto& placement) { return (centre(placement) - first).norm() < 1e-6; });
}

BoardFit fit_whole(const Image8& grey, const Board& board, const BoardHypothesis& hypothesis,
                   const CheckerboardOptions& options) {
  std::vector<BoardPlacement> placements = hypothesis.placements;
  if (placements.size() > 1) {
    if (!board.ambiguous_under_half_turn() || !cover_the_same(placements)) {
      BoardFit fit;
      const auto [seen_short, seen_long] = std::minmax({hypothesis.grid.extent_i(), hypothesis.grid.extent_j()});
      const auto [wanted_short, wanted_long] = std::minmax({board.inner_corners_x(), board.inner_corners_y()});
      fit.why_not = Finding(
          "board.another",
          {{"seen_long", seen_long}, {"seen_short", seen_short}, {"long", wanted_long}, {"short", wanted_short}});
      return fit;
    }
    keep_upright(board, &placements);
  }
  return fit_board(grey, board, placements.front(), options);
}

// Some corners are missing from the grid: the placement that finds them in the image is the right one. Where several
// do, the board may lie one square further, and is not taken.
BoardFit complete(const Image8& grey, const Board& board, const BoardHypothesis& hypothesis,
                  const CheckerboardOptions& options) {
  BoardFit best;
  if (hypothesis.placements.size() > kMaxPlacements) return best;
  int fits = 0;
  for (const BoardPlacement& placement : hypothesis.placements) {
    BoardFit fit = fit_board(grey, board, placement, options);
    if (fit.corners.empty()) {
      if (best.corners.empty()) best.why_not = fit.why_not;
      best.fitted = std::max(best.fitted, fit.fitted);
      continue;
    }
    ++fits;
    if (fit.corners.size() > best.corners.size()) best = std::move(fit);
  }
  if (fits > 1) best.corners.clear();
  return best;
}

BoardFit fit_hypothesis(const Image8& grey, const Board& board, const BoardHypothesis& hypothesis,
                        const CheckerboardOptions& options) {
  const bool whole = hypothesis.corners == static_cast<std::size_t>(board.corner_count());
  return whole ? fit_whole(grey, board, hypothesis, options) : complete(grey, board, hypothesis, options);
}

// From each corner to its neighbours [px].
std::vector<double> edges_of(const CornerGrid& grid) {
  std::vector<double> edges;
  for (const auto& [place, p] : grid.corners)
    for (const auto& next : {std::pair(place.first + 1, place.second), std::pair(place.first, place.second + 1)}) {
      const auto found = grid.corners.find(next);
      if (found != grid.corners.end()) edges.push_back((found->second - p).norm());
    }
  return edges;
}

// The image ends within one square of the grid, so the rest of the board may lie beyond.
bool touches_border(const CornerGrid& grid, const Image8& grey) {
  double longest = 0.0;
  for (const double edge : edges_of(grid)) longest = std::max(longest, edge);
  return std::any_of(grid.corners.begin(), grid.corners.end(), [&](const auto& corner) {
    const Vector2d& p = corner.second;
    return std::min({p.x(), p.y(), grey.width - 1 - p.x(), grey.height - 1 - p.y()}) < 1.3 * longest;
  });
}

// How far the corners are, by the median, from where a plane of equal squares would have them [px]. Of boards in the
// demo's pictures that is .004 squares, of flecks on its floor that chain by chance .09 and more.
double off_plane_px(const CornerGrid& grid) {
  constexpr double kNoPlane = std::numeric_limits<double>::infinity();
  std::vector<detection::PlanePoint> points;
  for (const auto& [place, p] : grid.corners) points.push_back({Vector2d(place.first, place.second), p});
  const std::optional<detection::Homography> H = detection::Homography::fit(points);
  if (!H) return kNoPlane;
  std::vector<double> distances;
  for (const auto& [place, p] : points) {
    Vector2d mapped;
    if (!H->map(place, &mapped)) return kNoPlane;
    distances.push_back((mapped - p).norm());
  }
  return median(distances);
}

bool lies_unevenly(const CornerGrid& grid) {
  constexpr double kMostUneven = 0.08, kCoarse_px = 1.0;  // corners of low squares are found that coarsely
  return off_plane_px(grid) > std::max(kMostUneven * median(edges_of(grid)), kCoarse_px);
}

// Corners of the board alone, more of them and more evenly than chance lays them: four or five lie on some plane,
// whatever they are of.
bool lies_on_a_plane(const BoardHypothesis& part) {
  constexpr std::size_t kToldFromChance = 8;
  constexpr double kEven = 0.03;
  return part.fits_exactly() && part.corners >= kToldFromChance &&
         off_plane_px(part.grid) <= kEven * median(edges_of(part.grid));
}

/// What of the board was seen, where it was not measured.
struct BoardPart {
  BoardHypothesis hypothesis;
  bool on_plane = false, uneven = false;

  explicit BoardPart(const BoardHypothesis& seen)
      : hypothesis(seen), on_plane(lies_on_a_plane(seen)), uneven(lies_unevenly(seen.grid)) {}

  // More corners do, but for flecks beside what is surely a board's.
  bool tells_more_than(const BoardPart& other) const {
    if (on_plane && other.uneven) return true;
    if (uneven && other.on_plane) return false;
    return hypothesis.corners > other.hypothesis.corners;
  }
};

Finding reason_for_part(const BoardHypothesis& part, const Image8& grey, const Board& board) {
  if (touches_border(part.grid, grey)) return Finding("board.cut_off");
  return Finding("board.partly_hidden", {{"corners", part.corners}, {"of", board.corner_count()}});
}

/// Looks for the board level by level and remembers the best failure.
class BoardFinder {
 public:
  BoardFinder(const Image8& grey, const Board& board, const CheckerboardOptions& options)
      : grey_(grey), board_(board), options_(options), pyramid_(grey) {}

  BoardDetection find() {
    // Whole grids of any level before parts: a part may belong to something else that is chequered.
    for (const std::size_t level : pyramid_.search_order()) {
      hypotheses_.push_back(detection::rank_hypotheses(detection::search_grids(pyramid_, level, 4), board_));
      if (try_hypotheses(hypotheses_.back(), board_.corner_count())) return std::move(fit_.corners);
    }
    if (try_parts()) return std::move(fit_.corners);
    // Where corners lie unevenly nothing hides a board: it was never there. Floors and labels chain saddles by chance.
    if (!best_part_ || best_part_->uneven) return BoardNotFound{Finding("board.not_found")};
    if (why_not_) return BoardNotFound{*why_not_};
    const Finding reason = reason_for_part(best_part_->hypothesis, grey_, board_);
    // So it is where many of the corners are none when looked at closely.
    constexpr double kMostAreCorners = 0.75;
    const double least =
        std::max<double>(part_size(), kMostAreCorners * static_cast<double>(best_part_->hypothesis.corners));
    const bool never_there = reason.code == "board.partly_hidden" && most_fitted_ < least;
    return BoardNotFound{never_there ? Finding("board.not_found") : reason};
  }

 private:
  bool try_hypotheses(const std::vector<BoardHypothesis>& hypotheses, int min_corners) {
    for (const BoardHypothesis& hypothesis : hypotheses) {
      if (hypothesis.corners < static_cast<std::size_t>(min_corners)) break;
      fit_ = fit_hypothesis(grey_, board_, hypothesis, options_);
      most_fitted_ = std::max(most_fitted_, fit_.fitted);
      if (!fit_.corners.empty()) return true;
      keep_as_part(hypothesis);
    }
    return false;
  }
  void keep_as_part(const BoardHypothesis& hypothesis) {
    const BoardPart part(hypothesis);
    if (best_part_ && !part.tells_more_than(*best_part_)) return;
    best_part_ = part;
    // Only a whole grid's fit knows better than the grid itself why it cannot be used.
    const bool whole = hypothesis.corners == static_cast<std::size_t>(board_.corner_count());
    why_not_ = whole ? fit_.why_not : std::nullopt;
  }
  // Parts of two boards in one image: the one with more corners, and neither where they are equal.
  bool try_parts() {
    BoardFit best;
    bool unique = true;
    for (const std::vector<BoardHypothesis>& of_level : hypotheses_) {
      for (const BoardHypothesis& hypothesis : of_level) {
        if (!try_hypotheses({hypothesis}, part_size())) continue;
        const bool same = !best.corners.empty() && same_board(best.corners, fit_.corners);
        if (fit_.corners.size() == best.corners.size() && !same) unique = false;
        if (fit_.corners.size() <= best.corners.size()) continue;
        best = std::move(fit_);
        unique = true;
      }
    }
    fit_ = std::move(best);
    if (!unique) why_not_ = Finding("board.two");
    return unique && !fit_.corners.empty();
  }
  static bool same_board(const std::vector<CornerObservation>& a, const std::vector<CornerObservation>& b) {
    constexpr double kSamePlacePx = 2.0;
    for (const CornerObservation& corner : a)
      for (const CornerObservation& other : b)
        if (corner.id == other.id) return (corner.pixel - other.pixel).norm() < kSamePlacePx;
    return false;
  }
  int part_size() const { return std::max(4, static_cast<int>(kPartOfBoard * board_.corner_count())); }

  const Image8& grey_;
  const Board& board_;
  const CheckerboardOptions& options_;
  Pyramid pyramid_;
  std::vector<std::vector<BoardHypothesis>> hypotheses_;  ///< by level searched
  BoardFit fit_;
  std::optional<BoardPart> best_part_;
  int most_fitted_ = 0;  ///< corners of one hypothesis
  std::optional<Finding> why_not_;
};

}  // namespace

BoardDetection detect_checkerboard(const Image8& image, const Board& board, const CheckerboardOptions& options) {
  if (board.inner_corners_x() < 2 || board.inner_corners_y() < 2)
    return BoardNotFound{Finding("board.too_few_squares")};
  if (std::min(image.width, image.height) < kMinImageSize) return BoardNotFound{Finding("image.too_small")};
  if (image.channels == 1) return BoardFinder(image, board, options).find();
  return BoardFinder(detection::to_grey(image), board, options).find();
}

std::optional<CheckerboardSize> find_any_checkerboard(const Image8& image) {
  if (std::min(image.width, image.height) < kMinImageSize) return std::nullopt;
  Pyramid pyramid(detection::to_grey(image));
  for (const std::size_t level : pyramid.search_order()) {
    for (const CornerGrid& grid : detection::search_grids(pyramid, level, 6)) {
      const int a = grid.extent_i(), b = grid.extent_j();
      if (grid.is_full() && std::min(a, b) >= 2 && std::max(a, b) >= 3)
        return CheckerboardSize{std::max(a, b), std::min(a, b)};
    }
  }
  return std::nullopt;
}

std::string describe_size_mismatch(const CheckerboardSize& seen, const Board& board) {
  const int a = seen.inner_corners_long, b = seen.inner_corners_short;
  std::string text = "the board in the images seems to have " + size_text(a, b) +
                     " inner corners = " + size_text(a + 1, b + 1) + " squares; the rig says squares [" +
                     std::to_string(board.squares_x) + ", " + std::to_string(board.squares_y) + "]";
  if (size_text(board.squares_x, board.squares_y) == size_text(a, b))
    text += " (inner corners given for squares: write [" + std::to_string(board.squares_x + 1) + ", " +
            std::to_string(board.squares_y + 1) + "])";
  return text;
}

}  // namespace rigproof
