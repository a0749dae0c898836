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

std::vector<Eigen::Vector4d> board_shapes(const Observations& observations, const Result& result) {
  std::vector<Eigen::Vector4d> shapes(static_cast<std::size_t>(observations.boards()), Eigen::Vector4d::Zero());
  for (int b = 0; b < observations.boards(); ++b) {
    Eigen::Vector4d& shape = shapes[static_cast<std::size_t>(b)];
    for (const EstimatedQuantity& quantity : result.also_estimated) {
      if (quantity.name == ml::name_of_board("board_ratio_percent", b)) shape[1] = 0.01 * quantity.value;
      if (quantity.name == ml::name_of_board("board_bow_x_mm", b)) shape[2] = 0.001 * quantity.value;
      if (quantity.name == ml::name_of_board("board_bow_y_mm", b)) shape[3] = 0.001 * quantity.value;
    }
  }
  return shapes;
}

}  // namespace rigproof::inspect_detail
