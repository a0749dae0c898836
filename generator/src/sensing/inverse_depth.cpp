#include "inverse_depth.h"

#include "rigproof/core/vector_clones.h"

namespace rigproof {

RIGPROOF_VECTOR_CLONES
void invert_row(const float* depth, std::size_t width, float factor, float* out) {
  for (std::size_t x = 0; x < width; ++x) {
    const float z = depth[x];
    out[x] = z > 0.0F ? factor / z : 0.0F;
  }
}

}  // namespace rigproof
