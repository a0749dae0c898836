#include "corner_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>

namespace rigproof::detection {
namespace {

using Eigen::Vector2f;

constexpr int kNone = -1;

/// Which candidate lies at a pixel.
class CandidateMap {
 public:
  CandidateMap(const SmoothImage& image, const std::vector<SaddleCandidate>& candidates)
      : width_(image.width), height_(image.height) {
    cells_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                  static_cast<std::int16_t>(kNone));
    // Strongest last, so that it wins a shared pixel.
    for (std::size_t i = candidates.size(); i-- > 0;) {
      const int x = static_cast<int>(std::lround(candidates[i].position.x()));
      const int y = static_cast<int>(std::lround(candidates[i].position.y()));
      if (inside(x, y)) cells_[index(x, y)] = static_cast<std::int16_t>(i);
    }
  }
  /// Nearest candidate other than `self` within two pixels.
  int near(const Vector2f& p, int self) const {
    const int cx = static_cast<int>(std::lround(p.x())), cy = static_cast<int>(std::lround(p.y()));
    int best = kNone, best_distance = 9;
    for (int y = cy - 2; y <= cy + 2; ++y) {
      for (int x = cx - 2; x <= cx + 2; ++x) {
        if (!inside(x, y)) continue;
        const int found = cells_[index(x, y)];
        const int distance = (x - cx) * (x - cx) + (y - cy) * (y - cy);
        if (found == kNone || found == self || distance >= best_distance) continue;
        best = found;
        best_distance = distance;
      }
    }
    return best;
  }

 private:
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_, height_;
  std::vector<std::int16_t> cells_;
};

struct Link {
  int candidate = kNone;
  int edge = 0;  ///< edge of that candidate that leads back
};

Vector2f clockwise_normal(const Vector2f& direction) { return {-direction.y(), direction.x()}; }

/// Follows the edge between two squares from one saddle to the next.
class EdgeWalker {
 public:
  EdgeWalker(const SmoothImage& image, const std::vector<SaddleCandidate>& candidates)
      : image_(image), candidates_(candidates), map_(image, candidates) {}

  Link walk(int from, int edge) const {
    const SaddleCandidate& start = candidates_[static_cast<std::size_t>(from)];
    Vector2f direction = start.edges[static_cast<std::size_t>(edge)];
    const float sign = edge % 2 == 0 ? 1.0F : -1.0F;
    const int max_steps = (image_.width + image_.height) / 2;
    Vector2f p = start.position + kFirstStep * direction;
    int steps_without_edge = 0;
    for (int step = 0; step < max_steps; ++step, p += direction) {
      if (step > 0) {
        const int found = map_.near(p, from);
        if (found != kNone) {
          const int back = edge_back(found, start.position, edge);
          if (back != kNone) return {found, back};
        }
      }
      if (!follow(start, sign, &p, &direction)) {
        // The edge fades where the next corner is near; look a little further.
        if (++steps_without_edge > 3) return {};
      } else {
        steps_without_edge = 0;
      }
    }
    return {};
  }

 private:
  static constexpr float kFirstStep = 3.0F;
  static constexpr float kHalfProfile = 2.0F;

  // Moves p back onto the edge; false if there is no edge of the right sign.
  bool follow(const SaddleCandidate& start, float sign, Vector2f* p, Vector2f* direction) const {
    const Vector2f n = clockwise_normal(*direction);
    const Vector2f a = *p + kHalfProfile * n, b = *p - kHalfProfile * n;
    if (!image_.contains(a.x(), a.y()) || !image_.contains(b.x(), b.y()) || !image_.contains(p->x(), p->y()))
      return false;
    const float high = image_.sample(a.x(), a.y()), low = image_.sample(b.x(), b.y());
    const float rise = high - low;
    if (rise * sign < 0.35F * start.contrast) return false;
    // Between the two samples the profile is nearly straight around the edge.
    const float excess = 0.5F * (high + low) - image_.sample(p->x(), p->y());
    const float shift = std::clamp(2.0F * kHalfProfile * 0.7F * excess / rise, -0.7F, 0.7F);
    *p += shift * n;
    const Vector2f whole = *p - start.position;
    const float length = whole.norm();
    if (length > 6.0F) *direction = whole / length;
    return true;
  }

  // The edge of `found` that points to `origin` and has the other order of colours: an edge that is dark to light
  // in the sense of rotation at one end is light to dark at the other.
  int edge_back(int found, const Vector2f& origin, int edge) const {
    const SaddleCandidate& candidate = candidates_[static_cast<std::size_t>(found)];
    const Vector2f to_origin = origin - candidate.position;
    const float distance = to_origin.norm();
    if (distance < 4.0F) return kNone;
    for (int back = 1 - edge % 2; back < 4; back += 2)
      if (candidate.edges[static_cast<std::size_t>(back)].dot(to_origin) > 0.88F * distance) return back;
    return kNone;
  }

  const SmoothImage& image_;
  const std::vector<SaddleCandidate>& candidates_;
  CandidateMap map_;
};

using Links = std::vector<std::array<Link, 4>>;

// Links that both ends agree on.
Links find_links(const SmoothImage& image, const std::vector<SaddleCandidate>& candidates) {
  const EdgeWalker walker(image, candidates);
  Links walks(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (int edge = 0; edge < 4; ++edge)
      walks[i][static_cast<std::size_t>(edge)] = walker.walk(static_cast<int>(i), edge);
  Links links = walks;
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (Link& link : links[i]) {
      if (link.candidate == kNone) continue;
      const Link& back = walks[static_cast<std::size_t>(link.candidate)][static_cast<std::size_t>(link.edge)];
      if (back.candidate != static_cast<int>(i)) link = {};
    }
  }
  return links;
}

struct Node {
  int candidate;
  int i, j;
  int edge_i;  ///< which of its edges points along +i
};

constexpr std::array<std::pair<int, int>, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

CornerGrid grow_from(std::size_t first, const std::vector<SaddleCandidate>& candidates, const Links& links,
                     std::vector<bool>* used) {
  CornerGrid grid;
  // Edge 0 is +i; the square clockwise of it is light as edge 0 goes from dark to light.
  grid.first_square_dark = false;
  std::deque<Node> queue = {{static_cast<int>(first), 0, 0, 0}};
  (*used)[first] = true;
  while (!queue.empty()) {
    const Node node = queue.front();
    queue.pop_front();
    const SaddleCandidate& candidate = candidates[static_cast<std::size_t>(node.candidate)];
    if (!grid.corners.emplace(std::pair(node.i, node.j), candidate.position.cast<double>()).second) continue;
    for (int step = 0; step < 4; ++step) {
      const int edge = (node.edge_i + step) % 4;
      const Link& link = links[static_cast<std::size_t>(node.candidate)][static_cast<std::size_t>(edge)];
      if (link.candidate == kNone || (*used)[static_cast<std::size_t>(link.candidate)]) continue;
      (*used)[static_cast<std::size_t>(link.candidate)] = true;
      // At the neighbour, link.edge points against this step, so the edge of this step is the opposite one.
      const int edge_i = (link.edge + 2 - step + 4) % 4;
      const auto [di, dj] = kSteps[static_cast<std::size_t>(step)];
      queue.push_back({link.candidate, node.i + di, node.j + dj, edge_i});
    }
  }
  return grid;
}

void find_extent(CornerGrid* grid) {
  bool first = true;
  for (const auto& [coordinates, position] : grid->corners) {
    const auto [i, j] = coordinates;
    grid->i_min = first ? i : std::min(grid->i_min, i);
    grid->i_max = first ? i : std::max(grid->i_max, i);
    grid->j_min = first ? j : std::min(grid->j_min, j);
    grid->j_max = first ? j : std::max(grid->j_max, j);
    first = false;
  }
}

/// A rectangle of the grid and how the board's axes lie in it.
struct Frame {
  int i0, j0;          ///< corner 0
  int xi, xj, yi, yj;  ///< steps of the board's x and y in (i, j)
};

// The square between corner 0 and its diagonal neighbour is dark, as the outer diagonal one is.
bool colours_fit(const CornerGrid& grid, const Frame& frame) {
  const int i = std::min(frame.i0, frame.i0 + frame.xi + frame.yi);
  const int j = std::min(frame.j0, frame.j0 + frame.xj + frame.yj);
  return grid.is_dark(i, j);
}

BoardPlacement read_placement(const CornerGrid& grid, const Board& board, const Frame& frame) {
  BoardPlacement placement;
  for (int id = 0; id < board.corner_count(); ++id) {
    const int x = id % board.inner_corners_x(), y = id / board.inner_corners_x();
    const auto found =
        grid.corners.find({frame.i0 + x * frame.xi + y * frame.yi, frame.j0 + x * frame.xj + y * frame.yj});
    if (found != grid.corners.end()) placement.seeds.emplace_back(id, found->second);
  }
  return placement;
}

}  // namespace

std::vector<CornerGrid> grow_corner_grids(const SmoothImage& image, const std::vector<SaddleCandidate>& candidates,
                                          std::size_t min_corners) {
  const Links links = find_links(image, candidates);
  std::vector<bool> used(candidates.size(), false);
  std::vector<CornerGrid> grids;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (used[i]) continue;
    CornerGrid grid = grow_from(i, candidates, links, &used);
    if (grid.corners.size() < min_corners) continue;
    find_extent(&grid);
    grids.push_back(std::move(grid));
  }
  std::stable_sort(grids.begin(), grids.end(),
                   [](const CornerGrid& a, const CornerGrid& b) { return a.corners.size() > b.corners.size(); });
  return grids;
}

std::vector<BoardPlacement> place_board(const CornerGrid& grid, const Board& board) {
  // The four rotations that keep y clockwise of x; a mirrored order cannot arise.
  constexpr std::array<std::array<int, 4>, 4> kAxes = {{{1, 0, 0, 1}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}}};
  const int reach = std::max(board.inner_corners_x(), board.inner_corners_y()) - 1;
  std::vector<BoardPlacement> best;
  for (const auto& axes : kAxes) {
    for (int i0 = grid.i_min - reach; i0 <= grid.i_max + reach; ++i0) {
      for (int j0 = grid.j_min - reach; j0 <= grid.j_max + reach; ++j0) {
        const Frame frame{i0, j0, axes[0], axes[1], axes[2], axes[3]};
        if (!colours_fit(grid, frame)) continue;
        BoardPlacement placement = read_placement(grid, board, frame);
        if (placement.seeds.empty() || (!best.empty() && placement.seeds.size() < best.front().seeds.size())) continue;
        if (!best.empty() && placement.seeds.size() > best.front().seeds.size()) best.clear();
        best.push_back(std::move(placement));
      }
    }
  }
  return best;
}

}  // namespace rigproof::detection
