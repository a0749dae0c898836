// A board spread over several pages: where they are cut, what is on each, and how they are put together.
#pragma once

#include <optional>
#include <vector>

#include "board_page.h"

namespace rigproof {

struct TilePlan {
  TileGrid grid;
  Paper paper{};
  /// Where the sheet is cut, from its left and from its top [mm], its own edges first and last.
  std::vector<double> cuts_x_mm, cuts_y_mm;
};

/// The way of the paper that takes fewer pages, upright if both take as many; nothing where a page has no room for a
/// piece, or for "fit".
std::optional<TilePlan> best_tiles(const BoardSheet& sheet, const BoardPrint& print);

/// How the tiles are put together, and then they, row by row. Throws Error where they cannot be.
std::vector<BoardPage> tile_pages(const Board& board, const BoardPrint& print);

}  // namespace rigproof
