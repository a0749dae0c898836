// 1/z of depth images, as disparities and edges go with it.
#pragma once

#include <cstddef>

namespace rigproof {

/// out = factor / z, and 0 where nothing is.
void invert_row(const float* depth, std::size_t width, float factor, float* out);

}  // namespace rigproof
