#include "board_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/pdf.h"

namespace rigproof {
namespace {

// Beside a piece of the board: crosses; below it: the ruler across, and two lines of text.
constexpr double kMarks_mm = 6.0, kCrossAway_mm = 3.0, kCrossArm_mm = 2.5, kFooter_mm = 17.0;
// Printed beyond the cut, so that a cut which misses it leaves no white edge.
constexpr double kBleed_mm = 2.0;
constexpr double kLeastPiece_mm = 20.0;
constexpr int kMostPages = 200;
constexpr double kText_mm = 3.0, kLine_mm = 4.6;

struct Room {
  double width_mm, height_mm;
};
Room room_of(const Paper& paper, double margin_mm) {
  return {paper.width_mm - 2.0 * (margin_mm + kMarks_mm) - kRulerStrip_mm,
          paper.height_mm - 2.0 * (margin_mm + kMarks_mm) - kFooter_mm};
}

// Along one side of the sheet.
struct Side {
  double length_mm, room_mm, overlap_mm, first_mm, square_mm;
  double step_mm() const { return room_mm - overlap_mm - kBleed_mm; }
  int pieces() const { return 1 + std::max(0, static_cast<int>(std::ceil((length_mm - room_mm) / step_mm() - 1e-9))); }
};

// From low to high, as far from the corners as can be, and near to `wish`: the middle of a square where there is one.
double good_cut(const Side& side, double low_mm, double high_mm, double wish_mm) {
  const auto middle = [&](double k) { return side.first_mm + (k + 0.5) * side.square_mm; };
  const double nearest = std::round((wish_mm - side.first_mm) / side.square_mm - 0.5);
  double best = wish_mm;
  const auto away = [&](double cut) {
    const double squares = (cut - side.first_mm) / side.square_mm;
    return std::abs(squares - std::round(squares));
  };
  for (const double cut : {low_mm, high_mm, middle(nearest), middle(nearest - 1.0), middle(nearest + 1.0)})
    if (cut >= low_mm && cut <= high_mm && away(cut) > away(best) + 1e-9) best = cut;
  return best;
}

std::vector<double> cuts_of(const Side& side) {
  const int pieces = side.pieces();
  std::vector<double> cuts = {0.0};
  for (int piece = 0; piece + 1 < pieces; ++piece) {
    const int left = pieces - 1 - piece;
    const double high = cuts.back() + side.step_mm() + (piece == 0 ? kBleed_mm : 0.0);
    const double low = side.length_mm - left * side.step_mm() - side.overlap_mm;
    const double even = cuts.back() + (side.length_mm - cuts.back()) / (left + 1);
    cuts.push_back(good_cut(side, low, high, std::clamp(even, low, high)));
  }
  cuts.push_back(side.length_mm);
  return cuts;
}

std::optional<TilePlan> tiles_on(const Paper& paper, const BoardSheet& sheet, const BoardPrint& print) {
  const Room room = room_of(paper, 1000.0 * print.printer_margin_m);
  const double overlap = 1000.0 * print.overlap_m;
  const Side x{sheet.width_mm, room.width_mm, overlap, sheet.first_mm, sheet.square_mm};
  const Side y{sheet.height_mm, room.height_mm, overlap, sheet.first_mm, sheet.square_mm};
  if (std::min(x.step_mm(), y.step_mm()) < kLeastPiece_mm) return std::nullopt;
  const TileGrid grid{y.pieces(), x.pieces()};
  if (grid.count() > kMostPages) return std::nullopt;
  return TilePlan{grid, paper, cuts_of(x), cuts_of(y)};
}

TilePlan plan_of(const BoardSheet& sheet, const BoardPrint& print) {
  if (const auto plan = best_tiles(sheet, print)) return *plan;
  if (papers_of(print.paper).empty())
    throw Error("tiles: fit is one page, however large; name the printer's paper, e.g. a4");
  throw Error("tiles: a board of " + pdf_number(sheet.width_mm, 1) + " x " + pdf_number(sheet.height_mm, 1) +
              " mm cannot be spread over at most " + std::to_string(kMostPages) + " pages of " + print.paper +
              "; take larger paper, or smaller margins and overlap");
}

struct Tile {
  int row, column;  // from 0
};
int page_number(const TilePlan& plan, const Tile& tile) { return 2 + tile.row * plan.grid.columns + tile.column; }

std::string place_words(const TilePlan& plan, const Tile& tile) {
  return "row " + std::to_string(tile.row + 1) + ", column " + std::to_string(tile.column + 1) + " of " +
         std::to_string(plan.grid.rows) + " x " + std::to_string(plan.grid.columns);
}

std::string page_words(const TilePlan& plan, int number) {
  return "page " + std::to_string(number) + " of " + std::to_string(plan.grid.count() + 1);
}

std::string glue_words(const TilePlan& plan, const Tile& tile) {
  const std::string beside = "Cut through the crosses at the left and glue it onto page " +
                             std::to_string(page_number(plan, {tile.row, tile.column - 1})) + ".";
  if (tile.column > 0) return beside;
  if (tile.row == 0) return "Not cut: the others come onto this one.";
  return "Once its row is whole: cut the row through the crosses at the top and glue it onto row " +
         std::to_string(tile.row) + ".";
}

// Beyond each end of the cuts, outside of the piece.
void add_crosses(const std::array<double, 2>& xs, const std::array<double, 2>& ys, const PageArea& piece,
                 BoardPage* page) {
  const auto cross = [page](double x, double y) {
    page->lines.push_back({x - kCrossArm_mm, y, x + kCrossArm_mm, y, 0.15});
    page->lines.push_back({x, y - kCrossArm_mm, x, y + kCrossArm_mm, 0.15});
  };
  for (const double x : xs)
    for (const double y : {piece.y0_mm - kCrossAway_mm, piece.y1_mm + kCrossAway_mm}) cross(x, y);
  for (const double y : ys)
    for (const double x : {piece.x0_mm - kCrossAway_mm, piece.x1_mm + kCrossAway_mm}) cross(x, y);
}

BoardPage tile_page(const Board& board, const BoardSheet& sheet, const BoardPrint& print, const TilePlan& plan,
                    const Tile& tile) {
  const double margin = 1000.0 * print.printer_margin_m, overlap = 1000.0 * print.overlap_m;
  const auto column = static_cast<std::size_t>(tile.column), row = static_cast<std::size_t>(tile.row);
  const double from_x = plan.cuts_x_mm[column], to_x = plan.cuts_x_mm[column + 1];
  const double from_y = plan.cuts_y_mm[row], to_y = plan.cuts_y_mm[row + 1];
  // The piece as it lies in the sheet, y down; then where sheet's points are on the page.
  const double x0 = std::max(0.0, from_x - kBleed_mm), x1 = std::min(sheet.width_mm, to_x + overlap);
  const double y0 = std::max(0.0, from_y - kBleed_mm), y1 = std::min(sheet.height_mm, to_y + overlap);
  BoardPage page;
  page.width_mm = plan.paper.width_mm;
  page.height_mm = plan.paper.height_mm;
  const double left = margin + kRulerStrip_mm + kMarks_mm, top = page.height_mm - margin - kMarks_mm;
  const double shift_x = left - x0, shift_y = top + y0;  // page x = sheet x + shift; page y = shift - sheet y
  const PageArea piece{left, shift_y - y1, shift_x + x1, top};
  const double sheet_bottom = shift_y - sheet.height_mm;
  for (const PageArea& area : sheet.dark) {
    const PageArea seen{std::max(piece.x0_mm, shift_x + area.x0_mm), std::max(piece.y0_mm, sheet_bottom + area.y0_mm),
                        std::min(piece.x1_mm, shift_x + area.x1_mm), std::min(piece.y1_mm, sheet_bottom + area.y1_mm)};
    if (seen.x0_mm < seen.x1_mm && seen.y0_mm < seen.y1_mm) page.dark.push_back(seen);
  }
  add_crosses({shift_x + from_x, shift_x + to_x}, {shift_y - from_y, shift_y - to_y}, piece, &page);
  add_rulers(left, page.width_mm - margin, margin + kFooter_mm - 1.0, margin, &page);
  page.texts.push_back(
      {left, margin + 1.5 + kLine_mm, kText_mm,
       place_words(plan, tile) + "   (" + page_words(plan, page_number(plan, tile)) + ", " + board_words(board) + ")"});
  page.texts.push_back({left, margin + 1.5, kText_mm, glue_words(plan, tile)});
  return page;
}

std::vector<std::string> assembly_words(const TilePlan& plan, const BoardSheet& sheet, const BoardPrint& print) {
  std::vector<std::string> words = {
      std::to_string(plan.grid.rows) + " rows x " + std::to_string(plan.grid.columns) + " columns of " + print.paper +
          "; put together " + pdf_number(sheet.width_mm, 1) + " x " + pdf_number(sheet.height_mm, 1) + " mm",
      "1. Print this page first, and check both its rulers. Then print the others, and check theirs."};
  int step = 1;
  const auto add = [&](const std::string& line, const std::string& rest) {
    words.push_back(std::to_string(++step) + ". " + line);
    if (!rest.empty()) words.push_back("    " + rest);
  };
  if (plan.grid.columns > 1)
    add("In each row, from the second column on: cut through the two crosses at the left, lay the page",
        "onto the one to its left so that its half crosses complete those there, and glue it.");
  if (plan.grid.rows > 1)
    add("From the second row on: cut the whole row through the crosses at the top, and glue it onto the row",
        "above so that the half crosses at its ends complete those there.");
  add("Cut the board out through the outermost crosses.", "");
  return words;
}

// The sheet in small, upper left corner at (left, top): its cuts, and the number of each page.
void add_sketch(const BoardSheet& sheet, const TilePlan& plan, double left_mm, double top_mm, double scale,
                BoardPage* page) {
  const double height = scale * sheet.height_mm, bottom = top_mm - height;
  for (const PageArea& area : sheet.dark)
    page->pale.push_back({left_mm + scale * area.x0_mm, bottom + scale * area.y0_mm, left_mm + scale * area.x1_mm,
                          bottom + scale * area.y1_mm});
  for (const double cut : plan.cuts_x_mm)
    page->lines.push_back({left_mm + scale * cut, bottom, left_mm + scale * cut, top_mm, 0.3});
  for (const double cut : plan.cuts_y_mm)
    page->lines.push_back({left_mm, top_mm - scale * cut, left_mm + scale * sheet.width_mm, top_mm - scale * cut, 0.3});
  for (int row = 0; row < plan.grid.rows; ++row)
    for (int column = 0; column < plan.grid.columns; ++column) {
      const auto x = static_cast<std::size_t>(column), y = static_cast<std::size_t>(row);
      const double width = plan.cuts_x_mm[x + 1] - plan.cuts_x_mm[x];
      const double size =
          std::min({6.0, 0.3 * scale * width, 0.5 * scale * (plan.cuts_y_mm[y + 1] - plan.cuts_y_mm[y])});
      const double middle_x = left_mm + 0.5 * scale * (plan.cuts_x_mm[x] + plan.cuts_x_mm[x + 1]);
      const double middle_y = top_mm - 0.5 * scale * (plan.cuts_y_mm[y] + plan.cuts_y_mm[y + 1]);
      const std::string number = std::to_string(page_number(plan, {row, column}));
      const double digits = static_cast<double>(number.size());
      page->texts.push_back({middle_x - 0.28 * digits * size, middle_y - 0.35 * size, size, number});
    }
}

BoardPage assembly_page(const Board& board, const BoardSheet& sheet, const BoardPrint& print, const TilePlan& plan) {
  const double margin = 1000.0 * print.printer_margin_m;
  BoardPage page;
  page.width_mm = plan.paper.width_mm;
  page.height_mm = plan.paper.height_mm;
  const double left = margin + kRulerStrip_mm + kMarks_mm;
  const PageRulers rulers = add_rulers(left, page.width_mm - margin, margin + kFooter_mm - 1.0, margin, &page);
  double y = page.height_mm - margin - 10.0;
  page.texts.push_back({left, y, 1.3 * kText_mm, page_words(plan, 1) + ": how the pages are put together"});
  std::vector<std::string> words = {board_words(board)};
  for (std::string& line : assembly_words(plan, sheet, print)) words.push_back(std::move(line));
  for (std::string& line : checking_words(board, rulers)) words.push_back(std::move(line));
  for (const std::string& line : words) page.texts.push_back({left, y -= kLine_mm, kText_mm, line});
  const double top = y - kLine_mm, bottom = margin + kFooter_mm + 5.0;
  const double scale = std::min((page.width_mm - margin - left) / sheet.width_mm, (top - bottom) / sheet.height_mm);
  if (scale > 0.0) add_sketch(sheet, plan, left, top, scale, &page);
  return page;
}

}  // namespace

std::optional<TilePlan> best_tiles(const BoardSheet& sheet, const BoardPrint& print) {
  std::optional<TilePlan> best;
  for (const Paper& paper : papers_of(print.paper)) {
    std::optional<TilePlan> plan = tiles_on(paper, sheet, print);
    if (plan && (!best || plan->grid.count() < best->grid.count())) best = std::move(plan);
  }
  return best;
}

std::vector<BoardPage> tile_pages(const Board& board, const BoardPrint& print) {
  const BoardSheet sheet = board_sheet(board, print.border_m);
  const TilePlan plan = plan_of(sheet, print);
  std::vector<BoardPage> pages = {assembly_page(board, sheet, print, plan)};
  for (int row = 0; row < plan.grid.rows; ++row)
    for (int column = 0; column < plan.grid.columns; ++column)
      pages.push_back(tile_page(board, sheet, print, plan, {row, column}));
  return pages;
}

TileGrid tile_grid(const Board& board, const BoardPrint& print) {
  if (!print.tiles || fits_one_page(board, print)) return {};
  return plan_of(board_sheet(board, print.border_m), print).grid;
}

}  // namespace rigproof
