#include "rigproof/core/pdf.h"

#include <fmt/core.h>

#include <algorithm>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

bool is_printable(char c) { return c >= ' ' && c <= '~'; }

std::string file_of(const std::vector<std::string>& objects) {
  std::string pdf = "%PDF-1.7\n";
  std::string table = "xref\n0 " + std::to_string(objects.size() + 1) + "\n0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", pdf.size());
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t start = pdf.size();
  return pdf + table + "trailer\n<< /Size " + std::to_string(objects.size() + 1) + " /Root 1 0 R >>\nstartxref\n" +
         std::to_string(start) + "\n%%EOF\n";
}

}  // namespace

std::string pdf_number(double value, int decimals) {
  std::string result = fixed_text(value, decimals);
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

std::string pdf_document(const std::vector<PdfPage>& pages) {
  // The catalog, the pages, two fonts; then each page and its content.
  std::vector<std::string> objects(4);
  std::string kids, wishes;
  for (const PdfPage& page : pages) {
    const std::string number = std::to_string(objects.size() + 1), content = std::to_string(objects.size() + 2);
    kids += number + " 0 R ";
    objects.push_back("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + pdf_number(page.width_pt) + " " +
                      pdf_number(page.height_pt) + "] /Contents " + content +
                      " 0 R /Resources << /Font << /F1 3 0 R /F2 4 0 R >> " + page.resources + ">> >>");
    objects.push_back("<< /Length " + std::to_string(page.operators.size()) + " >>\nstream\n" + page.operators +
                      "endstream");
  }
  if (std::any_of(pages.begin(), pages.end(), [](const PdfPage& page) { return page.print_at_true_size; }))
    wishes =
        " /ViewerPreferences << /PrintScaling /None" + std::string(pages.size() > 1 ? " /Duplex /Simplex" : "") + " >>";
  objects[0] = "<< /Type /Catalog /Pages 2 0 R" + wishes + " >>";
  objects[1] = "<< /Type /Pages /Kids [" + kids + "] /Count " + std::to_string(pages.size()) + " >>";
  objects[2] = "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>";
  objects[3] = "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica-Bold >>";
  return file_of(objects);
}

}  // namespace rigproof
