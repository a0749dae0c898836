#include "board_options.h"

#include <cstdio>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

// "6x5".
void read_squares(const std::string& text, Board* board) {
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &board->squares_x, &board->squares_y, &rest) != 2 || board->squares_x < 3 ||
      board->squares_y < 3 || board->squares_x > 64 || board->squares_y > 64)
    throw Error("--squares: " + text + ": must be two numbers from 3 to 64, columns x rows, e.g. 6x5");
}

}  // namespace

Board board_of(const BoardOptions& arguments) {
  Board board = arguments.preset.empty() ? Board() : load_board(arguments.preset);
  if (arguments.preset.empty() && (arguments.squares.empty() || arguments.square_mm == 0.0))
    throw Error("board: give a preset, as `rigproof boards` lists them, or --squares and --square-mm");
  Problems problems;
  for (const auto& [option, given] : {std::pair("--type", !arguments.type.empty()),
                                      {"--squares", !arguments.squares.empty()},
                                      {"--square-mm", arguments.square_mm != 0.0}})
    if (given && !arguments.preset.empty())
      problems.add({"", 0, option, "", "contradicts the preset " + arguments.preset + ", which says it; give one"});
  problems.throw_if_any();
  if (!arguments.type.empty()) board.type = arguments.type;
  if (!arguments.squares.empty()) read_squares(arguments.squares, &board);
  if (arguments.square_mm != 0.0) board.square_m = 1e-3 * arguments.square_mm;
  if (board.type == "checkerboard" && board.ambiguous_under_half_turn())
    throw Error("--squares: " + std::to_string(board.squares_x) + "x" + std::to_string(board.squares_y) +
                ": turned by 180 degrees this checkerboard looks the same, so that no program can tell its first "
                "corner; take one even and one odd number, e.g. " +
                std::to_string(board.squares_x) + "x" + std::to_string(board.squares_y - 1));
  return board;
}

}  // namespace rigproof
