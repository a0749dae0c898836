#include "rigproof/core/pdf.h"

#include <fmt/core.h>

#include <array>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

bool is_printable(char c) { return c >= ' ' && c <= '~'; }

std::string file_of(const std::array<std::string, 6>& objects) {
  std::string pdf = "%PDF-1.6\n";
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

std::string pdf_document(const PdfPage& page) {
  const std::string scaling = page.print_at_true_size ? " /ViewerPreferences << /PrintScaling /None >>" : "";
  const std::string size = pdf_number(page.width_pt) + " " + pdf_number(page.height_pt);
  return file_of(
      {"<< /Type /Catalog /Pages 2 0 R" + scaling + " >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
       "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + size +
           "] /Contents 4 0 R /Resources << /Font << /F1 5 0 R /F2 6 0 R >> " + page.resources + ">> >>",
       "<< /Length " + std::to_string(page.operators.size()) + " >>\nstream\n" + page.operators + "endstream",
       "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
       "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica-Bold >>"});
}

}  // namespace rigproof
