// Seamless noise on a square picture: the raw material of procedural textures.
#pragma once

#include <cstdint>
#include <vector>

namespace rigproof {

/// A square of floats, row-major.
struct NoiseField {
  int size = 0;
  std::vector<float> values;

  explicit NoiseField(int size_px, float fill = 0.0F)
      : size(size_px), values(static_cast<std::size_t>(size_px) * static_cast<std::size_t>(size_px), fill) {}
  float& at(int x, int y) { return values[index(x, y)]; }
  float at(int x, int y) const { return values[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x);
  }
};

/// Uniform in [0, 1), a function of the lattice point and the seed alone.
float lattice_value(std::uint64_t seed, int x, int y);

/// Value noise summed over octaves (each twice as fine and `gain` times as strong), scaled to mean 0 and
/// standard deviation 1. `cells_x` and `cells_y` are the lattice cells of the coarsest octave across the picture.
NoiseField fractal_noise(int size_px, std::uint64_t seed, int cells_x, int cells_y, int octaves, float gain = 0.5F);

/// Worley noise: distances to the nearest and second nearest of jittered points, one a cell, in units of a cell, and a
/// random value of the nearest point.
struct CellularNoise {
  NoiseField nearest, second, value;
};
CellularNoise cellular_noise(int size_px, std::uint64_t seed, int cells);

}  // namespace rigproof
