// The least of PDF: one page of vector graphics with Helvetica.
#pragma once

#include <string>

namespace rigproof {

/// A page in points (1/72 inch), its origin in the lower left corner.
struct PdfPage {
  double width_pt = 0.0;
  double height_pt = 0.0;
  std::string operators;            ///< content stream; fonts F1 (Helvetica) and F2 (Helvetica-Bold) are there
  std::string resources;            ///< further entries of the resource dictionary
  bool print_at_true_size = false;  ///< asks viewers not to scale it to the paper
};

/// The document's bytes; the same for the same page.
std::string pdf_document(const PdfPage& page);

/// Without needless zeros.
std::string pdf_number(double value, int decimals = 4);
/// A string object, "(as \(this\))". What is not ASCII becomes a question mark.
std::string pdf_string(const std::string& words);

}  // namespace rigproof
