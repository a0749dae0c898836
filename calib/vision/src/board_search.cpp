#include "board_search.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace rigproof::detection {
namespace {

// A texture can chain many saddles; the board is among the largest grids.
constexpr std::size_t kGridsTried = 8;
constexpr int kSearchSize = 960;
constexpr int kSmallestLevel = 48;

double size_in_image(const CornerGrid& grid) {
  Eigen::AlignedBox2d box;
  for (const auto& corner : grid.corners) box.extend(corner.second);
  return box.diagonal().norm();
}

}  // namespace

const Image8& Pyramid::level(std::size_t index) {
  while (levels_.size() <= index) levels_.push_back(halve(levels_.back()));
  return levels_[index];
}

std::vector<std::size_t> Pyramid::search_order() const {
  const Image8& full = levels_.front();
  const int size = std::max(full.width, full.height);
  std::size_t start = 0;
  while ((size >> start) > kSearchSize) ++start;
  std::vector<std::size_t> order = {start};
  for (std::size_t level = start; level-- > 0;) order.push_back(level);
  if ((std::min(full.width, full.height) >> (start + 1)) >= kSmallestLevel) order.push_back(start + 1);
  return order;
}

std::vector<CornerGrid> search_grids(Pyramid& pyramid, std::size_t level, std::size_t min_corners) {
  const SmoothImage image = smooth(pyramid.level(level));
  std::vector<CornerGrid> grids = grow_corner_grids(image, find_saddle_candidates(image), min_corners);
  const double scale = static_cast<double>(std::size_t{1} << level);
  for (CornerGrid& grid : grids)
    for (auto& [coordinates, position] : grid.corners)
      position = (scale * (position.array() + 0.5) - 0.5).matrix();  // pixel centres are integers
  return grids;
}

std::vector<BoardHypothesis> rank_hypotheses(const std::vector<CornerGrid>& grids, const Board& board) {
  std::vector<BoardHypothesis> hypotheses;
  for (std::size_t i = 0; i < std::min(grids.size(), kGridsTried); ++i) {
    std::vector<BoardPlacement> placements = place_board(grids[i], board);
    if (placements.empty()) continue;
    const std::size_t corners = placements.front().seeds.size();
    hypotheses.push_back({std::move(placements), corners, grids[i]});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(), [](const BoardHypothesis& a, const BoardHypothesis& b) {
    if (a.corners != b.corners) return a.corners > b.corners;
    if (a.fits_exactly() != b.fits_exactly()) return a.fits_exactly();
    return size_in_image(a.grid) > size_in_image(b.grid);
  });
  return hypotheses;
}

}  // namespace rigproof::detection
