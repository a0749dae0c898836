// How high the board stands, so that all cameras of a rig see it, all over their images.
#pragma once

#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// The placement at another height: that from which most parts of the images are reached by a robot on level floor 1.2
/// to 3.6 m away, a camera that sees less weighing more. Depends on rig, board and lean alone, in steps of 5 cm, so
/// that neither seed nor world nor drive moves a board of the same lean.
/// @param margin_m white border of the sheet, which clears the floor by 5 cm
BoardPlacement at_fitting_height(const BoardPlacement& placement, const std::vector<WorldCamera>& cameras,
                                 const Board& board, double margin_m);

}  // namespace rigproof
