#include "as_estimated.h"

namespace rigproof::inspect_detail {

Observations as_estimated(Observations observations, const Result& result) {
  for (RigCamera& camera : observations.cameras)
    for (const EstimatedLens& lens : result.lenses)
      if (lens.camera == camera.name) camera.camera = lens.intrinsics;
  for (const EstimatedQuantity& quantity : result.also_estimated)
    if (quantity.name == "board_size_percent") observations.board.square_m *= 1.0 + 0.01 * quantity.value;
  return observations;
}

}  // namespace rigproof::inspect_detail
