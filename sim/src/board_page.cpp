#include "board_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "board_tiles.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/error.h"
#include "rigproof/core/pdf.h"
#include "rigproof/core/version.h"
#include "rigproof/sim/board_pattern.h"

namespace rigproof {
namespace {

// Below the board: ruler and four lines of text.
constexpr double kFooter_mm = 40.0;
constexpr double kRulerBelowBoard_mm = 8.0, kTick_mm = 3.0, kText_mm = 3.0, kLine_mm = 4.6, kSmallText_mm = 2.4;
constexpr double kLargestRuler_mm = 200.0, kRulerStep_mm = 50.0;
constexpr double kUnitRoom_mm = 10.0;                             // beyond a ruler's end
constexpr double kLeastWidth_mm = 150.0, kLeastHeight_mm = 26.0;  // of a page: its text, and 50 mm of ruler

struct NamedPaper {
  const char* name;
  double short_mm, long_mm;
};
constexpr std::array<NamedPaper, 7> kPapers = {{{"a4", 210.0, 297.0},
                                                {"a3", 297.0, 420.0},
                                                {"a2", 420.0, 594.0},
                                                {"a1", 594.0, 841.0},
                                                {"a0", 841.0, 1189.0},
                                                {"letter", 215.9, 279.4},
                                                {"tabloid", 279.4, 431.8}}};

// Where a page is narrow the upright ruler stands in the white around the squares, so far from them.
constexpr double kWhite_mm = 3.5;

// What a page has beside the sheet.
struct Frame {
  double left_mm, across_mm, upright_mm;
};
Frame frame_of(const BoardPrint& print) {
  const double margin = 1000.0 * print.printer_margin_m;
  const double strip = std::max(0.0, kRulerStrip_mm - std::max(0.0, 1000.0 * print.border_m - kWhite_mm));
  return {margin + strip, 2.0 * margin + strip, 2.0 * margin + kFooter_mm};
}

bool holds(const Paper& paper, const BoardSheet& sheet, const BoardPrint& print) {
  const Frame frame = frame_of(print);
  return sheet.width_mm + frame.across_mm <= paper.width_mm && sheet.height_mm + frame.upright_mm <= paper.height_mm;
}

// Its first corner at the top right.
BoardSheet turned(const BoardSheet& sheet) {
  BoardSheet result = sheet;
  std::swap(result.width_mm, result.height_mm);
  for (PageArea& area : result.dark)
    area = {area.y0_mm, sheet.width_mm - area.x1_mm, area.y1_mm, sheet.width_mm - area.x0_mm};
  return result;
}

struct Placed {
  Paper paper;
  BoardSheet sheet;
};

// The page upright or across, the board on it upright if it can.
std::optional<Placed> placed_on_one_page(const BoardSheet& sheet, const BoardPrint& print) {
  const Frame frame = frame_of(print);
  if (print.paper == "fit")
    return Placed{{std::max(sheet.width_mm, kLeastWidth_mm) + 2.0 * (1000.0 * print.printer_margin_m + kRulerStrip_mm),
                   std::max(sheet.height_mm, kLeastHeight_mm) + frame.upright_mm},
                  sheet};
  for (const BoardSheet& way : {sheet, turned(sheet)})
    for (const Paper& paper : papers_of(print.paper))
      if (holds(paper, way, print)) return Placed{paper, way};
  return std::nullopt;
}

// The largest squares that one page holds [mm].
double largest_square_mm(const Board& board, const BoardSheet& sheet, const BoardPrint& print) {
  const double border = 1000.0 * print.border_m;
  const double columns = (sheet.width_mm - 2.0 * border) / (1000.0 * board.square_m);
  const double rows = (sheet.height_mm - 2.0 * border) / (1000.0 * board.square_m);
  const Frame frame = frame_of(print);
  double largest = 0.0;
  for (const Paper& paper : papers_of(print.paper))
    for (const auto& [across, down] : {std::pair(columns, rows), std::pair(rows, columns)})
      largest = std::max(largest, std::min((paper.width_mm - frame.across_mm - 2.0 * border) / across,
                                           (paper.height_mm - frame.upright_mm - 2.0 * border) / down));
  return largest;
}

Error does_not_fit(const Board& board, const BoardSheet& sheet, const BoardPrint& print) {
  const double largest = largest_square_mm(board, sheet, print);
  std::string what = "paper " + print.paper + ": " + std::to_string(board.squares_x) + " x " +
                     std::to_string(board.squares_y) + " squares of " + pdf_number(1000.0 * board.square_m) +
                     " mm do not fit; ";
  if (largest >= 1.0) what += "squares of up to " + pdf_number(std::floor(largest)) + " mm do, or ";
  what += "take larger paper, e.g. fit";
  if (const auto plan = best_tiles(sheet, print))
    what += ", or tiles: " + std::to_string(plan->grid.count()) + " pages";
  return Error(what);
}

// One ruler's lines and numbers along either axis: `along` from its zero, `across` towards its ticks.
void add_ruler(double x0_mm, double y0_mm, double length_mm, bool upright, BoardPage* page) {
  const auto line = [&](double from, double to, double across_from, double across_to, double width) {
    if (upright)
      page->lines.push_back({x0_mm - across_from, y0_mm + from, x0_mm - across_to, y0_mm + to, width});
    else
      page->lines.push_back({x0_mm + from, y0_mm - across_from, x0_mm + to, y0_mm - across_to, width});
  };
  const auto words = [&](double along, const std::string& text) {
    // Numbers stand below the ticks; turned ones have their feet towards them.
    if (upright)
      page->texts.push_back({x0_mm - kTick_mm - 0.6, y0_mm + along, kSmallText_mm, text, true});
    else
      page->texts.push_back({x0_mm + along, y0_mm - kTick_mm - 2.2, kSmallText_mm, text, false});
  };
  line(0.0, length_mm, 0.0, 0.0, 0.2);
  for (int mm = 0; mm <= static_cast<int>(length_mm); ++mm) {
    const double share = mm % 50 == 0 ? 1.0 : (mm % 10 == 0 ? 0.7 : (mm % 5 == 0 ? 0.5 : 0.3));
    line(mm, mm, 0.0, share * kTick_mm, 0.1);
    if (mm % 50 == 0) words(mm + 0.8, std::to_string(mm) + (mm == static_cast<int>(length_mm) ? " mm" : ""));
  }
}

double ruler_length_mm(double room_mm) {
  return std::max(0.0, std::min(kLargestRuler_mm, kRulerStep_mm * std::floor(room_mm / kRulerStep_mm)));
}

}  // namespace

const std::vector<std::string>& paper_names() {
  static const std::vector<std::string> names = {"a4", "a3", "a2", "a1", "a0", "letter", "tabloid", "fit"};
  return names;
}

std::vector<Paper> papers_of(const std::string& name) {
  if (name == "fit") return {};
  for (const NamedPaper& paper : kPapers)
    if (name == paper.name) return {{paper.short_mm, paper.long_mm}, {paper.long_mm, paper.short_mm}};
  throw Error("paper: " + name + ": must be one of a4, a3, a2, a1, a0, letter, tabloid, fit");
}

BoardSheet board_sheet(const Board& board, double border_m) {
  const std::vector<DarkArea> areas = dark_areas(board);
  const double square = board.square_m;
  BoardSheet sheet;
  sheet.square_mm = 1000.0 * square;
  sheet.first_mm = 1000.0 * (border_m + overhang_m(board));
  sheet.width_mm = sheet.square_mm * board.squares_x + 2.0 * sheet.first_mm;
  sheet.height_mm = sheet.square_mm * board.squares_y + 2.0 * sheet.first_mm;
  const double left = sheet.first_mm + 1000.0 * first_corner_m(board), top = sheet.height_mm - left;
  for (const DarkArea& area : areas)
    sheet.dark.push_back(
        {left + 1000.0 * area.x0_m, top - 1000.0 * area.y1_m, left + 1000.0 * area.x1_m, top - 1000.0 * area.y0_m});
  return sheet;
}

PageRulers add_rulers(double left_mm, double right_mm, double across_y_mm, double printer_margin_mm, BoardPage* page) {
  const double top = page->height_mm - printer_margin_mm - kUnitRoom_mm;
  const PageRulers rulers{ruler_length_mm(right_mm - kUnitRoom_mm - left_mm), ruler_length_mm(top - printer_margin_mm)};
  add_ruler(left_mm, across_y_mm, rulers.across_mm, false, page);
  add_ruler(printer_margin_mm + kRulerStrip_mm - 0.5, top - rulers.upright_mm, rulers.upright_mm, true, page);
  return rulers;
}

std::string board_words(const Board& board) {
  const std::string dictionary = marker_dictionary(board);
  return board.type + ", " + std::to_string(board.squares_x) + " x " + std::to_string(board.squares_y) +
         " squares of " + pdf_number(1000.0 * board.square_m) + " mm" + (dictionary.empty() ? "" : ", " + dictionary) +
         "   (rigproof " + version() + ")";
}

std::vector<std::string> checking_words(const Board& board, const PageRulers& rulers) {
  const std::string columns = std::to_string(board.squares_x);
  const std::string span = board.has_tags()
                               ? "from the left edge of the first small square of a row to that of the last"
                               : "the " + columns + " squares of a row, outer edge to outer edge";
  return {"Print at 100 %, without scaling to the page. The rulers must measure " + pdf_number(rulers.across_mm) +
              " mm across, " + pdf_number(rulers.upright_mm) + " mm upright.",
          "Then measure " + span + ": " + pdf_number(1000.0 * board.square_m * board.squares_x) + " mm if exact.",
          "Give what you measure divided by " + columns + " as square_mm. Glue it onto a flat, stiff plate."};
}

bool fits_one_page(const Board& board, const BoardPrint& print) {
  return placed_on_one_page(board_sheet(board, print.border_m), print).has_value();
}

BoardPage board_page(const Board& board, const BoardPrint& print) {
  const BoardSheet upright = board_sheet(board, print.border_m);
  const std::optional<Placed> placed = placed_on_one_page(upright, print);
  if (!placed) throw does_not_fit(board, upright, print);
  const BoardSheet& sheet = placed->sheet;
  const double margin = 1000.0 * print.printer_margin_m;
  BoardPage page;
  page.width_mm = placed->paper.width_mm;
  page.height_mm = placed->paper.height_mm;
  const double left = std::max(0.5 * (page.width_mm - sheet.width_mm), frame_of(print).left_mm);
  const double bottom = page.height_mm - margin - sheet.height_mm;
  for (const PageArea& area : sheet.dark)
    page.dark.push_back({left + area.x0_mm, bottom + area.y0_mm, left + area.x1_mm, bottom + area.y1_mm});
  const double text_left = margin + kRulerStrip_mm + 1.5;
  const PageRulers rulers = add_rulers(text_left, page.width_mm - margin, bottom - kRulerBelowBoard_mm, margin, &page);
  double y = bottom - kRulerBelowBoard_mm - kTick_mm - 7.0;
  page.texts.push_back({text_left, y, kText_mm, board_words(board)});
  for (const std::string& words : checking_words(board, rulers))
    page.texts.push_back({text_left, y -= kLine_mm, kText_mm, words});
  return page;
}

}  // namespace rigproof
