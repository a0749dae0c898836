#include "rigproof/core/pdf.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace rigproof {
namespace {

// Of ' ' to '~' in thousandths of the size, by Adobe's metrics of the base fonts.
constexpr std::array<int, 95> kWidths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

bool is_printable(char c) { return c >= ' ' && c <= '~'; }

std::string joined(const std::array<std::string, 6>& objects) {
  std::string pdf = "%PDF-1.6\n";
  std::string table = "xref\n0 " + std::to_string(objects.size() + 1) + "\n0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    char offset[32];
    std::snprintf(offset, sizeof offset, "%010zu 00000 n \n", pdf.size());
    table += offset;
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t start = pdf.size();
  return pdf + table + "trailer\n<< /Size " + std::to_string(objects.size() + 1) + " /Root 1 0 R >>\nstartxref\n" +
         std::to_string(start) + "\n%%EOF\n";
}

}  // namespace

std::string pdf_number(double value, int decimals) {
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  std::string result = text;
  if (result.find('.') == std::string::npos) return result;
  result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

std::string pdf_string(const std::string& words) {
  std::string escaped;
  for (const char c : words) {
    if (c == '(' || c == ')' || c == '\\') escaped += '\\';
    escaped += is_printable(c) ? c : '?';
  }
  return "(" + escaped + ")";
}

double helvetica_width(const std::string& words) {
  int width = 0;
  for (const char c : words) width += kWidths[static_cast<std::size_t>((is_printable(c) ? c : '?') - ' ')];
  return 1e-3 * width;
}

std::string pdf_document(const PdfPage& page) {
  const std::string scaling = page.print_at_true_size ? " /ViewerPreferences << /PrintScaling /None >>" : "";
  const std::string size = pdf_number(page.width_pt) + " " + pdf_number(page.height_pt);
  return joined({"<< /Type /Catalog /Pages 2 0 R" + scaling + " >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                 "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + size +
                     "] /Contents 4 0 R /Resources << /Font << /F1 5 0 R /F2 6 0 R >> " + page.resources + ">> >>",
                 "<< /Length " + std::to_string(page.operators.size()) + " >>\nstream\n" + page.operators + "endstream",
                 "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
                 "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica-Bold >>"});
}

}  // namespace rigproof
