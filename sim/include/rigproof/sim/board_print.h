// A board to print at true size, with rulers that show whether the printer scaled it: as one page, or spread over pages
// of smaller paper that are glued together.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

struct BoardPrint {
  /// a4, a3, a2, a1, a0, letter, tabloid, or fit: as large as the board needs.
  std::string paper = "fit";
  double border_m = 0.01;           ///< white around the squares; detectors need some
  double printer_margin_m = 0.006;  ///< along each edge of a page, where printers leave it blank
  bool tiles = false;               ///< a board that is larger than the paper goes over several pages
  double overlap_m = 0.01;          ///< of tiles: how far a page reaches below the next one
};

/// "a4", ..., "fit".
const std::vector<std::string>& paper_names();

/// Tiles in rows and columns; 1 x 1: one page holds the board.
struct TileGrid {
  int rows = 1, columns = 1;
  int count() const { return rows * columns; }
};
/// Throws Error as board_pdf() does.
TileGrid tile_grid(const Board& board, const BoardPrint& print);

/// The PDF's bytes; the same for the same board. Board x points right and y down, as a viewer of a hung board sees it.
/// Tiles follow, row by row, on a page that tells how they are put together.
/// Throws Error where the board does not fit the paper, with the largest square that would, and where tiles cannot be.
std::string board_pdf(const Board& board, const BoardPrint& print);
/// One page as SVG, its unit the millimetre: outlines of the dark areas as one filled path.
std::string board_svg(const Board& board, const BoardPrint& print);
/// One page as DXF (R12, ASCII, in millimetres, y up), by layers: DARK has the dark areas as filled SOLIDs, OUTLINES,
/// which is off, the same as closed POLYLINEs, NOTES rulers and words, SHEET the edge of the page.
std::string board_dxf(const Board& board, const BoardPrint& print);

}  // namespace rigproof
