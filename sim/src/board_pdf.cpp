#include "rigproof/sim/board_pdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/pdf.h"
#include "rigproof/core/version.h"
#include "rigproof/sim/board_pattern.h"

namespace rigproof {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
// Printers leave this much of a page blank.
constexpr double kBlankEdge_mm = 6.0;
// Below the board: ruler and four lines of text.
constexpr double kFooter_mm = 40.0;
constexpr double kRulerBelowBoard_mm = 8.0, kTick_mm = 3.0, kText_mm = 3.0, kLine_mm = 4.6;
constexpr double kLargestRuler_mm = 200.0, kRulerStep_mm = 50.0;
constexpr double kLeastWidth_mm = 130.0;  // of a page, for the text

struct Paper {
  const char* name;
  double short_mm, long_mm;
};
constexpr std::array<Paper, 7> kPapers = {{{"a4", 210.0, 297.0},
                                           {"a3", 297.0, 420.0},
                                           {"a2", 420.0, 594.0},
                                           {"a1", 594.0, 841.0},
                                           {"a0", 841.0, 1189.0},
                                           {"letter", 215.9, 279.4},
                                           {"tabloid", 279.4, 431.8}}};

// Operators of a PDF content stream, in millimetres from the lower left corner of the page.
class Drawing {
 public:
  void rectangle(double x, double y, double width, double height) {
    text_ += coordinates({x, y, width, height}) + "re\n";
  }
  void fill() { text_ += "f\n"; }
  void line(double x0, double y0, double x1, double y1, double width_mm) {
    text_ += coordinates({width_mm}) + "w " + coordinates({x0, y0}) + "m " + coordinates({x1, y1}) + "l S\n";
  }
  void text(double x, double y, double size_mm, const std::string& words) {
    text_ += "BT /F1 " + coordinates({size_mm}) + "Tf " + coordinates({x, y}) + "Td " + pdf_string(words) + " Tj ET\n";
  }
  const std::string& operators() const { return text_; }

 private:
  static std::string coordinates(std::initializer_list<double> values_mm) {
    std::string text;
    for (const double value : values_mm) text += pdf_number(value * kPointsPerMm) + " ";
    return text;
  }

  std::string text_;
};

struct Page {
  double width_mm, height_mm;
  bool turned = false;  ///< the board lies on its side, its first corner at the top right
};

// The page upright or across, the board on it upright if it can.
std::optional<Page> page_that_holds(const Paper& paper, double width_mm, double height_mm, bool turned) {
  for (const Page& page : {Page{paper.short_mm, paper.long_mm, turned}, Page{paper.long_mm, paper.short_mm, turned}})
    if (width_mm + 2.0 * kBlankEdge_mm <= page.width_mm && height_mm + 2.0 * kBlankEdge_mm <= page.height_mm)
      return page;
  return std::nullopt;
}

Page page_of(const Board& board, const BoardPdfOptions& options) {
  const double border = 1000.0 * options.border_m;
  const double along_x = 1000.0 * board.square_m * board.squares_x + 2.0 * border;
  const double along_y = 1000.0 * board.square_m * board.squares_y + 2.0 * border;
  const double width = along_x, height = along_y + kFooter_mm;
  if (options.paper == "fit")
    return {std::max(width, kLeastWidth_mm) + 2.0 * kBlankEdge_mm, height + 2.0 * kBlankEdge_mm};
  for (const Paper& paper : kPapers) {
    if (options.paper != paper.name) continue;
    if (const auto page = page_that_holds(paper, width, height, false)) return *page;
    if (const auto page = page_that_holds(paper, along_y, along_x + kFooter_mm, true)) return *page;
    double largest = 0.0;
    for (const Page& page : {Page{paper.short_mm, paper.long_mm}, Page{paper.long_mm, paper.short_mm}})
      for (const auto& [columns, rows] :
           {std::pair(board.squares_x, board.squares_y), std::pair(board.squares_y, board.squares_x)})
        largest = std::max(largest, std::min((page.width_mm - 2.0 * (kBlankEdge_mm + border)) / columns,
                                             (page.height_mm - 2.0 * (kBlankEdge_mm + border) - kFooter_mm) / rows));
    throw Error(
        "paper " + options.paper + ": " + std::to_string(board.squares_x) + " x " + std::to_string(board.squares_y) +
        " squares of " + pdf_number(1000.0 * board.square_m) + " mm do not fit; " +
        (largest < 1.0 ? std::string() : "squares of up to " + pdf_number(std::floor(largest)) + " mm do, or ") +
        "take larger paper, e.g. fit");
  }
  throw Error("paper: " + options.paper + ": must be one of a4, a3, a2, a1, a0, letter, tabloid, fit");
}

void draw_ruler(double left_mm, double y_mm, double length_mm, Drawing* drawing) {
  drawing->line(left_mm, y_mm, left_mm + length_mm, y_mm, 0.2);
  for (int mm = 0; mm <= static_cast<int>(length_mm); ++mm) {
    const double height =
        mm % 50 == 0 ? kTick_mm : (mm % 10 == 0 ? 0.7 * kTick_mm : (mm % 5 == 0 ? 0.5 : 0.3) * kTick_mm);
    drawing->line(left_mm + mm, y_mm, left_mm + mm, y_mm - height, 0.1);
    if (mm % 50 == 0) drawing->text(left_mm + mm + 0.8, y_mm - kTick_mm - 1.0, 2.4, std::to_string(mm));
  }
  drawing->text(left_mm + length_mm + 2.0, y_mm - kTick_mm, 2.4, "mm");
}

std::vector<std::string> instructions(const Board& board, double ruler_mm) {
  const double square_mm = 1000.0 * board.square_m;
  const std::string counts = std::to_string(board.squares_x) + " x " + std::to_string(board.squares_y);
  const std::string dictionary = marker_dictionary(board);
  const std::string span =
      board.type == "aprilgrid"
          ? "from the left edge of the first to the left edge of the last small square of a row"
          : "the " + std::to_string(board.squares_x) + " squares of a row together, outer edge to outer edge";
  return {board.type + ", " + counts + " squares of " + pdf_number(square_mm) + " mm" +
              (dictionary.empty() ? "" : ", " + dictionary) + "   (rigproof " + version() + ")",
          "Print at 100 %, without scaling to the page. The ruler must measure " + pdf_number(ruler_mm) + " mm.",
          "Then measure " + span + ": " + pdf_number(square_mm * board.squares_x) + " mm if exact.",
          "Give what you measure divided by " + std::to_string(board.squares_x) +
              " as square_mm. Glue it onto a flat, stiff plate."};
}

std::string content(const Board& board, const BoardPdfOptions& options, const Page& page) {
  const double square_mm = 1000.0 * board.square_m, border = 1000.0 * options.border_m;
  const double along_x = square_mm * board.squares_x, along_y = square_mm * board.squares_y;
  const double width = page.turned ? along_y : along_x, height = page.turned ? along_x : along_y;
  const double left = 0.5 * (page.width_mm - width), top = page.height_mm - kBlankEdge_mm - border;
  Drawing drawing;
  for (const DarkArea& area : dark_areas(board)) {
    const double dx = 1000.0 * (area.x1_m - area.x0_m), dy = 1000.0 * (area.y1_m - area.y0_m);
    if (page.turned)
      drawing.rectangle(left + width - (1000.0 * area.y1_m + square_mm), top - (1000.0 * area.x1_m + square_mm), dy,
                        dx);
    else
      drawing.rectangle(left + 1000.0 * area.x0_m + square_mm, top - (1000.0 * area.y1_m + square_mm), dx, dy);
  }
  drawing.fill();
  const double text_left = kBlankEdge_mm + 4.0, ruler_y = top - height - border - kRulerBelowBoard_mm;
  const double room = page.width_mm - text_left - kBlankEdge_mm - 8.0;
  const double ruler = std::min(kLargestRuler_mm, kRulerStep_mm * std::floor(room / kRulerStep_mm));
  draw_ruler(text_left, ruler_y, ruler, &drawing);
  double y = ruler_y - kTick_mm - 7.0;
  for (const std::string& line : instructions(board, ruler)) {
    drawing.text(text_left, y, kText_mm, line);
    y -= kLine_mm;
  }
  return drawing.operators();
}

}  // namespace

const std::vector<std::string>& paper_names() {
  static const std::vector<std::string> names = {"a4", "a3", "a2", "a1", "a0", "letter", "tabloid", "fit"};
  return names;
}

std::string board_pdf(const Board& board, const BoardPdfOptions& options) {
  const Page page = page_of(board, options);
  PdfPage document;
  document.width_pt = page.width_mm * kPointsPerMm;
  document.height_pt = page.height_mm * kPointsPerMm;
  document.operators = content(board, options, page);
  document.print_at_true_size = true;
  return pdf_document(document);
}

}  // namespace rigproof
