// A board as options of a command say it.
#pragma once

#include <string>

#include "rigproof/core/board.h"

namespace rigproof {

struct BoardOptions {
  std::string preset;   ///< name or file; empty = by squares
  std::string type;     ///< empty = the preset's, or checkerboard
  std::string squares;  ///< "6x5"; empty = the preset's
  double square_mm = 0.0;

  bool any() const { return !preset.empty() || !squares.empty() || square_mm != 0.0; }
};
/// Throws Error for what is missing, contradicts, or cannot be told apart after half a turn.
Board board_of(const BoardOptions& options);

}  // namespace rigproof
