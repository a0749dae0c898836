// What is wrong with a real board: its print, its plate, and what has happened to it since.
#pragma once

#include <cstdint>

namespace rigproof {

struct BoardDefects {
  double print_scale_x = 1.0;  ///< true over nominal length along board x, about the middle of the squares
  double print_scale_y = 1.0;
  double bow_m = 0.0;      ///< the middle stands out towards the viewer by this; bent about board y, its two edges stay
  double glare = 0.0;      ///< a lamp's reflection: 1 = white in its middle
  double covered = 0.0;    ///< share of the sheet that a cloth over one corner hides, up to 0.4
  double dirt = 0.0;       ///< 1 = filthy
  std::uint64_t seed = 0;  ///< of where glare, cloth and dirt are

  bool on_surface() const { return glare > 0.0 || covered > 0.0 || dirt > 0.0; }
};

}  // namespace rigproof
