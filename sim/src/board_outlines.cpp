#include "board_outlines.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace rigproof {
namespace {

constexpr double kSame_mm = 1e-6;
// East, north, west, south.
constexpr std::array<int, 4> kStepX = {1, 0, -1, 0}, kStepY = {0, 1, 0, -1};

// The lines at which areas begin and end, ascending; what is nearer than kSame_mm is one.
std::vector<double> lines_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto same = [](double a, double b) { return b - a < kSame_mm; };
  values.erase(std::unique(values.begin(), values.end(), same), values.end());
  return values;
}

int line_at(const std::vector<double>& lines, double value) {
  return static_cast<int>(std::lower_bound(lines.begin(), lines.end(), value - kSame_mm) - lines.begin());
}

// For each crossing of the lines the directions in which an edge leaves it, dark to its left: one bit each.
class Edges {
 public:
  Edges(const std::vector<PageArea>& areas, const std::vector<double>& xs, const std::vector<double>& ys)
      : width_(static_cast<int>(xs.size())), height_(static_cast<int>(ys.size())) {
    std::vector<std::uint8_t> dark(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for (const PageArea& area : areas)
      for (int y = line_at(ys, area.y0_mm); y < line_at(ys, area.y1_mm); ++y)
        for (int x = line_at(xs, area.x0_mm); x < line_at(xs, area.x1_mm); ++x) dark[at(x, y)] = 1;
    const auto is_dark = [&](int x, int y) { return x >= 0 && y >= 0 && x < width_ && y < height_ && dark[at(x, y)]; };
    leaving_.resize(dark.size());
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        if (!is_dark(x, y)) continue;
        if (!is_dark(x, y - 1)) leaving_[at(x, y)] |= 1U;
        if (!is_dark(x + 1, y)) leaving_[at(x + 1, y)] |= 2U;
        if (!is_dark(x, y + 1)) leaving_[at(x + 1, y + 1)] |= 4U;
        if (!is_dark(x - 1, y)) leaving_[at(x, y + 1)] |= 8U;
      }
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool leaves(int x, int y, int direction) const { return ((leaving_[at(x, y)] >> direction) & 1U) != 0; }
  void remove(int x, int y, int direction) {
    leaving_[at(x, y)] = static_cast<std::uint8_t>(leaving_[at(x, y)] & ~(1U << direction));
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  std::vector<std::uint8_t> leaving_;
};

struct Crossing {
  int x, y;
};

// Where two areas touch at a corner, turning left stays at the same one. Removes the edges it goes along.
std::vector<Crossing> traced(Edges* edges, const Crossing& start, int direction) {
  std::vector<Crossing> corners = {start};
  std::vector<std::pair<Crossing, int>> gone;
  Crossing here = start;
  for (int heading = direction;;) {
    gone.emplace_back(here, heading);
    here = {here.x + kStepX[static_cast<std::size_t>(heading)], here.y + kStepY[static_cast<std::size_t>(heading)]};
    int next = heading;
    for (const int turn : {1, 0, 3})
      if (edges->leaves(here.x, here.y, (heading + turn) % 4)) {
        next = (heading + turn) % 4;
        break;
      }
    if (here.x == start.x && here.y == start.y && next == direction) break;
    if (next != heading) corners.push_back(here);
    heading = next;
  }
  for (const auto& [crossing, heading] : gone) edges->remove(crossing.x, crossing.y, heading);
  return corners;
}

}  // namespace

std::vector<std::vector<PagePoint>> outlines_of(const std::vector<PageArea>& areas) {
  std::vector<double> all_x, all_y;
  for (const PageArea& area : areas) {
    all_x.insert(all_x.end(), {area.x0_mm, area.x1_mm});
    all_y.insert(all_y.end(), {area.y0_mm, area.y1_mm});
  }
  const std::vector<double> xs = lines_of(std::move(all_x)), ys = lines_of(std::move(all_y));
  Edges edges(areas, xs, ys);
  std::vector<std::vector<PagePoint>> outlines;
  // The lowest and then leftmost point of an outline, which is met first, is a corner of it.
  for (int y = 0; y < edges.height(); ++y)
    for (int x = 0; x < edges.width(); ++x)
      for (int direction = 0; direction < 4; ++direction) {
        if (!edges.leaves(x, y, direction)) continue;
        std::vector<PagePoint> outline;
        for (const Crossing& corner : traced(&edges, {x, y}, direction))
          outline.push_back({xs[static_cast<std::size_t>(corner.x)], ys[static_cast<std::size_t>(corner.y)]});
        outlines.push_back(std::move(outline));
      }
  return outlines;
}

}  // namespace rigproof
