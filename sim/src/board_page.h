// A page of a board's print, in millimetres from its lower left corner: what PDF, SVG and DXF are made of.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/sim/board_print.h"

namespace rigproof {

struct PageArea {
  double x0_mm, y0_mm, x1_mm, y1_mm;
};
struct PageLine {
  double x0_mm, y0_mm, x1_mm, y1_mm, width_mm;
};
struct PageText {
  double x_mm, y_mm, size_mm;
  std::string words;     ///< ASCII, without what XML escapes
  bool upwards = false;  ///< turned by 90 degrees to the left
};
struct BoardPage {
  double width_mm = 0.0, height_mm = 0.0;
  std::vector<PageArea> dark;
  std::vector<PageArea> pale;  ///< of a sketch, below everything else
  std::vector<PageLine> lines;
  std::vector<PageText> texts;
};

/// The board with the white around it, its lower left corner at the origin, y up; upright, unless it is turned.
struct BoardSheet {
  double width_mm = 0.0, height_mm = 0.0;
  double first_mm = 0.0;  ///< from an edge to the first square
  double square_mm = 0.0;
  std::vector<PageArea> dark;
};
BoardSheet board_sheet(const Board& board, double border_m);

/// Beside the left edge of a page [mm], within what the printer can print: the upright ruler.
inline constexpr double kRulerStrip_mm = 6.5;

struct Paper {
  double width_mm, height_mm;
};
/// Upright and across; empty for "fit". Throws Error for an unknown name.
std::vector<Paper> papers_of(const std::string& name);

/// Rulers across and upright, as long as there is room, up to 200 mm.
struct PageRulers {
  double across_mm, upright_mm;
};
/// @param left_mm where the one across begins; it ends before `right_mm`. It hangs below across_y_mm.
/// The upright one ends below the top, and stands at the left edge.
PageRulers add_rulers(double left_mm, double right_mm, double across_y_mm, double printer_margin_mm, BoardPage* page);

/// What stands on every print: the board's measures; and how to check them.
std::string board_words(const Board& board);
std::vector<std::string> checking_words(const Board& board, const PageRulers& rulers);

/// The board on one page. Throws Error, as board_pdf() does.
BoardPage board_page(const Board& board, const BoardPrint& print);
/// Whether one page holds it.
bool fits_one_page(const Board& board, const BoardPrint& print);

}  // namespace rigproof
