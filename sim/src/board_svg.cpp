#include "board_outlines.h"
#include "board_page.h"
#include "rigproof/core/pdf.h"

namespace rigproof {
namespace {

std::string mm(double value) { return pdf_number(value, 7); }

// y down.
std::string path_of(const BoardPage& page) {
  std::string path;
  for (const std::vector<PagePoint>& outline : outlines_of(page.dark)) {
    char command = 'M';
    for (const PagePoint& point : outline) {
      path += command + mm(point.x_mm) + " " + mm(page.height_mm - point.y_mm);
      command = 'L';
    }
    path += "Z\n";
  }
  return path;
}

}  // namespace

std::string board_svg(const Board& board, const BoardPrint& print) {
  const BoardPage page = board_page(board, print);
  const std::string width = mm(page.width_mm), height = mm(page.height_mm);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "mm\" height=\"" + height +
                    "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n";
  svg += "<rect width=\"" + width + "\" height=\"" + height + "\" fill=\"#fff\"/>\n";
  svg += "<path id=\"dark\" fill=\"#000\" fill-rule=\"evenodd\" d=\"" + path_of(page) + "\"/>\n";
  svg += "<g id=\"rulers\" stroke=\"#000\">\n";
  for (const PageLine& line : page.lines)
    svg += "<line x1=\"" + mm(line.x0_mm) + "\" y1=\"" + mm(page.height_mm - line.y0_mm) + "\" x2=\"" + mm(line.x1_mm) +
           "\" y2=\"" + mm(page.height_mm - line.y1_mm) + "\" stroke-width=\"" + mm(line.width_mm) + "\"/>\n";
  svg += "</g>\n<g id=\"words\" font-family=\"Helvetica, Arial, sans-serif\">\n";
  for (const PageText& text : page.texts) {
    const std::string place = mm(text.x_mm) + " " + mm(page.height_mm - text.y_mm);
    svg += "<text transform=\"translate(" + place + ")" + (text.upwards ? " rotate(-90)" : "") + "\" font-size=\"" +
           mm(text.size_mm) + "\">" + text.words + "</text>\n";
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace rigproof
