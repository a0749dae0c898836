// Glare, a cloth and dirt on a board's texture.
#pragma once

#include "board_model.h"
#include "rigproof/sim/board_defects.h"

namespace rigproof {

/// @param margin_m white border: texels beyond it are on no surface
void soil(const Board& board, double margin_m, const BoardDefects& defects, BoardTexture* texture);

}  // namespace rigproof
