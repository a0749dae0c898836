// DXF of AutoCAD R12: pairs of lines, a group code and its value. What comes later (HATCH, LWPOLYLINE) many cutters and
// plotters do not read; SOLID is the filled area that R12 has.
#include "board_outlines.h"
#include "board_page.h"
#include "rigproof/core/pdf.h"

namespace rigproof {
namespace {

constexpr int kBlack = 7;  // of AutoCAD's colours: black on white, white on black

class DxfText {
 public:
  void add(int code, const std::string& value) { text_ += std::to_string(code) + "\n" + value + "\n"; }
  void add(int code, int value) { add(code, std::to_string(value)); }
  void add(int code, double value) { add(code, pdf_number(value, 7)); }
  /// Group codes of the n-th point: 10 + n, 20 + n, 30 + n.
  void point(int n, double x_mm, double y_mm) {
    add(10 + n, x_mm);
    add(20 + n, y_mm);
    add(30 + n, 0.0);
  }
  void entity(const char* type, const char* layer) {
    add(0, std::string(type));
    add(8, std::string(layer));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void add_header(const BoardPage& page, DxfText* dxf) {
  dxf->add(0, "SECTION");
  dxf->add(2, "HEADER");
  const auto variable = [dxf](const char* name, int code, const std::string& value) {
    dxf->add(9, std::string(name));
    dxf->add(code, value);
  };
  variable("$ACADVER", 1, "AC1009");
  variable("$INSUNITS", 70, "4");     // millimetres
  variable("$MEASUREMENT", 70, "1");  // metric
  variable("$FILLMODE", 70, "1");     // SOLIDs are filled
  dxf->add(9, "$EXTMIN");
  dxf->point(0, 0.0, 0.0);
  dxf->add(9, "$EXTMAX");
  dxf->point(0, page.width_mm, page.height_mm);
  dxf->add(0, "ENDSEC");
}

void add_table(const char* name, int entries, DxfText* dxf) {
  dxf->add(0, "TABLE");
  dxf->add(2, std::string(name));
  dxf->add(70, entries);
}

void add_layers(DxfText* dxf) {
  dxf->add(0, "SECTION");
  dxf->add(2, "TABLES");
  add_table("LTYPE", 1, dxf);
  dxf->add(0, "LTYPE");
  dxf->add(2, "CONTINUOUS");
  dxf->add(70, 0);
  dxf->add(3, "Solid line");
  dxf->add(72, 65);
  dxf->add(73, 0);
  dxf->add(40, 0.0);
  dxf->add(0, "ENDTAB");
  add_table("LAYER", 4, dxf);
  for (const char* layer : {"DARK", "OUTLINES", "NOTES", "SHEET"}) {
    dxf->add(0, "LAYER");
    dxf->add(2, std::string(layer));
    dxf->add(70, 0);
    dxf->add(62, std::string(layer) == "OUTLINES" ? -kBlack : kBlack);  // negative: off
    dxf->add(6, "CONTINUOUS");
  }
  dxf->add(0, "ENDTAB");
  dxf->add(0, "ENDSEC");
}

void add_polyline(const std::vector<PagePoint>& points, const char* layer, DxfText* dxf) {
  dxf->entity("POLYLINE", layer);
  dxf->add(66, 1);  // vertices follow
  dxf->point(0, 0.0, 0.0);
  dxf->add(70, 1);  // closed
  for (const PagePoint& point : points) {
    dxf->entity("VERTEX", layer);
    dxf->point(0, point.x_mm, point.y_mm);
  }
  dxf->entity("SEQEND", layer);
}

void add_notes(const BoardPage& page, DxfText* dxf) {
  for (const PageLine& line : page.lines) {
    dxf->entity("LINE", "NOTES");
    dxf->point(0, line.x0_mm, line.y0_mm);
    dxf->point(1, line.x1_mm, line.y1_mm);
  }
  for (const PageText& text : page.texts) {
    dxf->entity("TEXT", "NOTES");
    dxf->point(0, text.x_mm, text.y_mm);
    dxf->add(40, 0.7 * text.size_mm);  // height of capitals
    dxf->add(1, text.words);
    dxf->add(50, text.upwards ? 90.0 : 0.0);
  }
}

}  // namespace

std::string board_dxf(const Board& board, const BoardPrint& print) {
  const BoardPage page = board_page(board, print);
  DxfText dxf;
  add_header(page, &dxf);
  add_layers(&dxf);
  dxf.add(0, "SECTION");
  dxf.add(2, "ENTITIES");
  const double width = page.width_mm, height = page.height_mm;
  add_polyline({{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}}, "SHEET", &dxf);
  for (const PageArea& area : page.dark) {
    dxf.entity("SOLID", "DARK");
    // Its corners go row by row: the third lies above the first.
    dxf.point(0, area.x0_mm, area.y0_mm);
    dxf.point(1, area.x1_mm, area.y0_mm);
    dxf.point(2, area.x0_mm, area.y1_mm);
    dxf.point(3, area.x1_mm, area.y1_mm);
  }
  for (const std::vector<PagePoint>& outline : outlines_of(page.dark)) add_polyline(outline, "OUTLINES", &dxf);
  add_notes(page, &dxf);
  dxf.add(0, "ENDSEC");
  dxf.add(0, "EOF");
  return dxf.text();
}

}  // namespace rigproof
