#include "as_estimated.h"

#include "rigproof/calib/estimate/unknowns.h"

namespace rigproof::inspect_detail {

Observations as_estimated(Observations observations, const Result& result) {
  for (RigCamera& camera : observations.cameras)
    for (const EstimatedLens& lens : result.lenses)
      if (lens.camera == camera.name) camera.camera = lens.intrinsics;
  for (int b = 0; b < observations.boards(); ++b) {
    Board& board = b == 0 ? observations.board : observations.more_boards[static_cast<std::size_t>(b) - 1];
    for (const EstimatedQuantity& quantity : result.also_estimated)
      if (quantity.name == ml::name_of_board("board_size_percent", b)) board.square_m *= 1.0 + 0.01 * quantity.value;
  }
  return observations;
}

}  // namespace rigproof::inspect_detail
