// Finds a checkerboard and measures its inner corners to a few thousandths of a pixel, each with a covariance.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"

namespace rigproof {

/// The board was not found, or not whole; `why` says which (board.not_found, board.cut_off, ..).
struct BoardNotFound {
  Finding why;
};

using BoardDetection = std::variant<std::vector<CornerObservation>, BoardNotFound>;

struct CheckerboardOptions {
  /// Floor of a corner's standard deviation [px]: what the fit's own covariance cannot know (lens, print).
  double min_sigma_px = 0.003;
  /// A corner whose saddle fit leaves more than this many times the residual of its fellows is left out.
  double max_fit_residual_ratio = 5.0;
  /// Share of the corners that must be measured; the others may be hidden or spoilt by glare.
  double min_corner_share = 0.75;
  /// Other boards with markers that the image may show instead, which must be less likely by far.
  std::vector<Board> others = {};
};

/// Detects the board in an 8-bit grey or RGB image. Ids follow board.h: the first corner is told by the squares'
/// colours, so every camera and view agrees, and a mirrored order never arises. A board that looks the same after
/// half a turn is read as if it stood upright: x towards the right of the image. Corners come in the order of their
/// ids; a hidden or spoilt one is missing. Never throws on image content.
BoardDetection detect_checkerboard(const Image8& image, const Board& board, const CheckerboardOptions& options = {});

/// Inner corners of a checkerboard of whatever size.
struct CheckerboardSize {
  int inner_corners_long = 0;
  int inner_corners_short = 0;
};

/// The largest complete checkerboard in the image, at least 3 x 2 inner corners; tells what a wrong rig.yaml should
/// say. Never throws on image content.
std::optional<CheckerboardSize> find_any_checkerboard(const Image8& image);

/// "the board in the images seems to have 4x3 inner corners = 5x4 squares; the rig says squares [4, 3] (...)".
std::string describe_size_mismatch(const CheckerboardSize& seen, const Board& board);

}  // namespace rigproof
