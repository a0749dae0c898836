// Candidate places of a board in the image, to about a pixel.
#pragma once

#include <vector>

#include "corner_grid.h"

namespace rigproof::detection {

/// A grid and how the board may lie in it. Positions are pixels of the full image.
struct BoardHypothesis {
  std::vector<BoardPlacement> placements;  ///< equally good ones
  std::size_t corners = 0;                 ///< that each of them holds
  CornerGrid grid;

  bool fits_exactly() const { return corners == grid.corners.size(); }
};

/// Pyramid of a grey image; each level is made when it is first asked for.
class Pyramid {
 public:
  explicit Pyramid(const Image8& grey) : levels_{grey} {}
  const Image8& level(std::size_t index);
  /// Levels in the order in which they are worth searching: the one that is about 900 pixels wide, then finer ones,
  /// then a coarser one, which sees through blur.
  std::vector<std::size_t> search_order() const;

 private:
  std::vector<Image8> levels_;
};

/// Grids of one level, largest first, in pixels of the full image.
std::vector<CornerGrid> search_grids(Pyramid& pyramid, std::size_t level, std::size_t min_corners);

/// The grids in which the board may lie, those with the most of its corners first, exact ones before parts
/// of larger grids, large ones in the image before small ones.
std::vector<BoardHypothesis> rank_hypotheses(const std::vector<CornerGrid>& grids, const Board& board);

}  // namespace rigproof::detection
