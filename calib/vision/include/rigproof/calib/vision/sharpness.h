// How sharp and how well exposed an image is where the board is.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"

namespace rigproof {

/// Width of the edges of a detected board: twice the blur of the fits of its corners, the median [px]. A sharp image
/// has 1 to 2. Absent where too few corners have both neighbours.
std::optional<double> edge_width_px(const Image8& grey, const Board& board,
                                    const std::vector<CornerObservation>& corners);

enum class Exposure { kGood, kOver, kUnder };
/// Of a grey image, around the corners if there are any: over where more than a quarter of it (half of the light
/// squares) is white without detail, half of it where there is no board; under where hardly anything is brighter than
/// 60 of 255.
Exposure exposure_of(const Image8& grey, const std::vector<CornerObservation>& corners);

}  // namespace rigproof
