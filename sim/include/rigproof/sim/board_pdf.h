// A board to print: one page of vector graphics at true size, with a ruler that shows whether the printer scaled it.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

struct BoardPdfOptions {
  /// a4, a3, a2, a1, a0, letter, tabloid, or fit: as large as the board needs.
  std::string paper = "fit";
  double border_m = 0.01;  ///< white around the squares; detectors need some
};

/// "a4", ..., "fit".
const std::vector<std::string>& paper_names();

/// The PDF's bytes; the same for the same board. Board x points right and y down, as a viewer of a hung board sees it.
/// Throws Error where the board does not fit the paper, with the largest square that would.
std::string board_pdf(const Board& board, const BoardPdfOptions& options);

}  // namespace rigproof
