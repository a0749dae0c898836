// Finds a checkerboard and measures its inner corners to a few thousandths of a pixel, each with a covariance.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"

namespace rigproof {

/// The board was not found, or not whole; `reason` says which, in words ("no board", "board cut off", ...).
struct BoardNotFound {
  std::string reason;
};

using BoardDetection = std::variant<std::vector<CornerObservation>, BoardNotFound>;

struct CheckerboardOptions {
  /// Floor of a corner's standard deviation [px]: what the fit's own covariance cannot know (lens, print).
  double min_sigma_px = 0.003;
  /// A corner whose saddle fit leaves more than this many times the expected residual makes the view suspicious.
  double max_fit_residual_ratio = 5.0;
};

/// Detects the board in an 8-bit grey or RGB image. Ids follow board.h: the first corner is told by the squares'
/// colours, so every camera and view agrees. Never throws on image content.
BoardDetection detect_checkerboard(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

}  // namespace rigproof
