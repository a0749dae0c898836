// The board as MJCF: a thin box whose front carries the squares as one texture with explicit coordinates.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/sim/board_defects.h"
#include "rigproof/sim/world.h"

namespace rigproof {

inline constexpr const char* kBoardName = "rigproof_board";
/// Of the texture, mesh, body and geom of the first board, the second, ...: each begins with the first one's.
std::string board_name(std::size_t index);
/// Which board has the name; absent: none.
std::optional<std::size_t> board_of_name(const std::string& name);

/// Texture of the squares and a white frame of whole squares around them. A square has 2^k texels a side, so that
/// every mipmap level down to one texel a square keeps the edges where they are.
struct BoardTexture {
  int width = 0;
  int height = 0;
  int frame_squares = 1;
  std::vector<std::uint8_t> rgb;  ///< row 0 is the board's -y side
};
BoardTexture draw_board(const Board& board, double margin_m, const BoardDefects& defects = {});

/// <asset> and <body> of a board of that name at `pose_attributes` ("pos=.. quat=.."), with the printed face at z = 0,
/// seen from -z. A bowed board's face is made of strips.
struct BoardMjcf {
  std::string asset;
  std::string body;
};
BoardMjcf board_mjcf(const WorldBoard& board, const BoardTexture& texture, const std::string& called,
                     const std::string& pose_attributes);

}  // namespace rigproof
