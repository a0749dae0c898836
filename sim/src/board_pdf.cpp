#include <initializer_list>

#include "board_page.h"
#include "board_tiles.h"
#include "rigproof/core/pdf.h"

namespace rigproof {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;

std::string points(std::initializer_list<double> values_mm) {
  std::string text;
  for (const double value : values_mm) text += pdf_number(value * kPointsPerMm) + " ";
  return text;
}

std::string filled(const std::vector<PageArea>& areas) {
  std::string text;
  for (const PageArea& area : areas)
    text += points({area.x0_mm, area.y0_mm, area.x1_mm - area.x0_mm, area.y1_mm - area.y0_mm}) + "re\n";
  return areas.empty() ? text : text + "f\n";
}

std::string operators(const BoardPage& page) {
  std::string text;
  if (!page.pale.empty()) text += "0.8 g\n" + filled(page.pale) + "0 g\n";
  text += filled(page.dark);
  for (const PageLine& line : page.lines)
    text += points({line.width_mm}) + "w " + points({line.x0_mm, line.y0_mm}) + "m " +
            points({line.x1_mm, line.y1_mm}) + "l S\n";
  for (const PageText& words : page.texts)
    text += "BT /F1 " + points({words.size_mm}) + "Tf " + (words.upwards ? "0 1 -1 0 " : "1 0 0 1 ") +
            points({words.x_mm, words.y_mm}) + "Tm " + pdf_string(words.words) + " Tj ET\n";
  return text;
}

}  // namespace

std::string board_pdf(const Board& board, const BoardPrint& print) {
  const bool one_page = !print.tiles || fits_one_page(board, print);
  std::vector<PdfPage> document;
  for (const BoardPage& page : one_page ? std::vector<BoardPage>{board_page(board, print)} : tile_pages(board, print)) {
    PdfPage paper;
    paper.width_pt = page.width_mm * kPointsPerMm;
    paper.height_pt = page.height_mm * kPointsPerMm;
    paper.operators = operators(page);
    paper.print_at_true_size = true;
    document.push_back(paper);
  }
  return pdf_document(document);
}

}  // namespace rigproof
