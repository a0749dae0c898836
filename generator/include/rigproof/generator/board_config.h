// What is wrong with the board of a run.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "rigproof/core/board.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/random.h"
#include "rigproof/sim/board_defects.h"

namespace rigproof {

/// What is random of a board of a run: the first is number 0.
RandomStream stream_of_board(std::uint64_t seed, const std::string& purpose, std::size_t index);
/// "board" or "more_boards[0]", as the configuration calls it.
std::string key_of_board(std::size_t index);

/// Drawn once a run. The recording tells the nominal board; truth/truth.yaml what was drawn.
struct BoardDefectsConfig {
  Distribution print_scale_x = 1.0;
  Distribution print_scale_y = 1.0;
  Distribution bow_mm = Distribution::Kind(Distribution::Normal{0.0, 0.3});
  Distribution print_error_mm = Distribution::Kind(Distribution::Uniform{0.05, 0.1});
  Distribution border_mm = 50.0;
  Distribution glare = 0.0;
  Distribution covered_percent = 0.0;
  Distribution dirt = 0.0;

  void visit(FieldVisitor& visitor);
};

struct BoardDefectsDraw {
  BoardDefects defects;
  double border_m = 0.05;               ///< white around the squares
  double print_error_m = 0.0;           ///< one sigma of BoardDefects::corner_shifts_m
  std::map<std::string, double> drawn;  ///< for the truth, by field
};
BoardDefectsDraw draw_board_defects(const BoardDefectsConfig& config, const Board& board, std::uint64_t seed,
                                    std::size_t index = 0);

}  // namespace rigproof
