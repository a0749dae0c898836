// The least of PDF: pages of vector graphics with Helvetica.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// A page in points (1/72 inch), its origin in the lower left corner.
struct PdfPage {
  double width_pt = 0.0;
  double height_pt = 0.0;
  std::string operators;            ///< content stream; fonts F1 (Helvetica) and F2 (Helvetica-Bold) are there
  std::string resources;            ///< further entries of the resource dictionary
  bool print_at_true_size = false;  ///< asks viewers not to scale the document to the paper
};

/// The document's bytes; the same for the same pages. Several of true size ask to be printed on one side of the paper.
std::string pdf_document(const std::vector<PdfPage>& pages);

/// Without needless zeros.
std::string pdf_number(double value, int decimals = 4);
/// A string object, "(as \(this\))". What is not ASCII becomes a question mark.
std::string pdf_string(const std::string& words);

}  // namespace rigproof
