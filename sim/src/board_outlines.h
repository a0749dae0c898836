// Outlines of areas that touch or overlap: what cutters and engravers follow, and what is filled without seams.
#pragma once

#include <vector>

#include "board_page.h"

namespace rigproof {

struct PagePoint {
  double x_mm, y_mm;
};

/// Closed outlines (the last point is not the first again), counter-clockwise with y up; of holes clockwise. Areas that
/// touch at a corner alone have outlines of their own.
std::vector<std::vector<PagePoint>> outlines_of(const std::vector<PageArea>& areas);

}  // namespace rigproof
