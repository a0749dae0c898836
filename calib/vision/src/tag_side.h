// How large an AprilGrid's tags are beside their distance, by its images.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/observations.h"

namespace rigproof::detection {

/// The side of the tags over the distance from tag to tag, as all views of a board together show it (a pixel's
/// hundredth tells it to some parts in 10^5, a ruler to one in 10^3). Absent where the views do not tell it.
std::optional<double> tag_share_in(const Observations& observations, int board);

}  // namespace rigproof::detection
