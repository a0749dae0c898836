// What is wrong with a real board: its print, its plate, and what has happened to it since.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

struct BoardDefects {
  double print_scale_x = 1.0;  ///< true over nominal length along board x, about the middle of the squares
  double print_scale_y = 1.0;
  double bow_m = 0.0;      ///< the middle stands out towards the viewer by this; bent about board y, its two edges stay
  double glare = 0.0;      ///< a lamp's reflection: 1 = white in its middle
  double covered = 0.0;    ///< share of the sheet that a cloth over one corner hides, up to 0.4
  double dirt = 0.0;       ///< 1 = filthy
  std::uint64_t seed = 0;  ///< of where glare, cloth and dirt are
  /// How far print and paper have moved each inner corner, by id [board frame]; between corners the sheet is stretched
  /// evenly. Empty = not at all.
  std::vector<Eigen::Vector2d> corner_shifts_m;

  bool on_surface() const { return glare > 0.0 || covered > 0.0 || dirt > 0.0; }
  /// Whether its corners lie elsewhere than the board says.
  bool moves_corners() const {
    return print_scale_x != 1.0 || print_scale_y != 1.0 || bow_m != 0.0 || !corner_shifts_m.empty();
  }
};

/// Where the inner corners of a board with defects are, by id [board frame].
/// @param margin_m white border around the squares: the bow reaches to its edge
std::vector<Eigen::Vector3d> printed_corners(const Board& board, double margin_m, const BoardDefects& defects);

}  // namespace rigproof
