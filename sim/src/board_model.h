// The board as MJCF: a thin box whose front carries the squares as one texture with explicit coordinates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/sim/board_defects.h"

namespace rigproof {

inline constexpr const char* kBoardName = "rigproof_board";

/// Texture of the squares and a white frame of whole squares around them. A square has 2^k texels a side, so that
/// every mipmap level down to one texel a square keeps the edges where they are.
struct BoardTexture {
  int width = 0;
  int height = 0;
  int frame_squares = 1;
  std::vector<std::uint8_t> rgb;  ///< row 0 is the board's -y side
};
BoardTexture draw_board(const Board& board, double margin_m, const BoardDefects& defects = {});

/// <asset> and <body> of a board at `pose_attributes` ("pos=.. quat=.."), with the printed face at z = 0, seen from -z.
/// A bowed board's face is made of strips.
struct BoardMjcf {
  std::string asset;
  std::string body;
};
BoardMjcf board_mjcf(const Board& board, double margin_m, double thickness_m, const BoardTexture& texture,
                     const std::string& pose_attributes, const BoardDefects& defects = {});

}  // namespace rigproof
