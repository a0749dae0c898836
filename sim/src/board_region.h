// Where the board may be seen in an image.
#pragma once

#include "resample.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// The rectangle of pixels that holds the whole board, cut to the image; empty if the printed face cannot be seen.
/// The whole image where part of the board is beyond what the lens projects.
PixelRect board_region(const Camera& camera, const Rigid3& T_camera_board, const Board& board, double margin_m);

/// How many times as fine as the image a board is drawn: a checkerboard 2 times; one with markers, whose cells' edges
/// would otherwise move the corners beside them, 4 times, or 8 where the cells are smaller than 2 px.
int board_refinement(const Camera& camera, const Rigid3& T_camera_board, const Board& board);

}  // namespace rigproof
