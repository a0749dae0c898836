#include "noise.h"

#include <algorithm>
#include <cmath>

namespace rigproof {
namespace {

float smooth_step(float t) { return t * t * (3.0F - 2.0F * t); }

int wrapped(int i, int period) { return ((i % period) + period) % period; }

// Adds one octave of value noise to the field.
void add_octave(NoiseField* field, std::uint64_t seed, int cells_x, int cells_y, float amplitude) {
  const int size = field->size;
  std::vector<float> row(static_cast<std::size_t>(cells_x) + 1);
  for (int y = 0; y < size; ++y) {
    const float v = static_cast<float>(y) * static_cast<float>(cells_y) / static_cast<float>(size);
    const int j = static_cast<int>(v);
    const float t = smooth_step(v - static_cast<float>(j));
    for (int i = 0; i <= cells_x; ++i) {
      const float above = lattice_value(seed, i % cells_x, j % cells_y);
      const float below = lattice_value(seed, i % cells_x, (j + 1) % cells_y);
      row[static_cast<std::size_t>(i)] = above + t * (below - above);
    }
    for (int x = 0; x < size; ++x) {
      const float u = static_cast<float>(x) * static_cast<float>(cells_x) / static_cast<float>(size);
      const auto i = static_cast<std::size_t>(u);
      const float s = smooth_step(u - static_cast<float>(i));
      field->at(x, y) += amplitude * (row[i] + s * (row[i + 1] - row[i]));
    }
  }
}

void standardise(NoiseField* field) {
  double sum = 0.0, squares = 0.0;
  for (const float value : field->values) {
    sum += static_cast<double>(value);
    squares += static_cast<double>(value) * static_cast<double>(value);
  }
  const double count = static_cast<double>(field->values.size());
  const double mean = sum / count, deviation = std::sqrt(std::max(squares / count - mean * mean, 1e-12));
  for (float& value : field->values) value = static_cast<float>((static_cast<double>(value) - mean) / deviation);
}

}  // namespace

float lattice_value(std::uint64_t seed, int x, int y) {
  // Finaliser of SplitMix64 over the coordinates.
  std::uint64_t h = seed ^ (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 0x9E3779B97F4A7C15ULL) ^
                    (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 0xC2B2AE3D27D4EB4FULL);
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBULL;
  return static_cast<float>((h ^ (h >> 31U)) >> 40U) * 0x1.0p-24F;
}

NoiseField fractal_noise(int size_px, std::uint64_t seed, int cells_x, int cells_y, int octaves, float gain) {
  NoiseField field(size_px);
  float amplitude = 1.0F;
  for (int octave = 0; octave < octaves && std::max(cells_x, cells_y) <= size_px; ++octave) {
    add_octave(&field, seed + static_cast<std::uint64_t>(octave) * 7919U, cells_x, cells_y, amplitude);
    amplitude *= gain;
    cells_x *= 2;
    cells_y *= 2;
  }
  standardise(&field);
  return field;
}

CellularNoise cellular_noise(int size_px, std::uint64_t seed, int cells) {
  CellularNoise noise{NoiseField(size_px), NoiseField(size_px), NoiseField(size_px)};
  for (int y = 0; y < size_px; ++y) {
    for (int x = 0; x < size_px; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) * static_cast<float>(cells) / static_cast<float>(size_px);
      const float v = (static_cast<float>(y) + 0.5F) * static_cast<float>(cells) / static_cast<float>(size_px);
      const int i = static_cast<int>(u), j = static_cast<int>(v);
      float first = 9.0F, second = 9.0F, value = 0.0F;
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          const int ci = wrapped(i + di, cells), cj = wrapped(j + dj, cells);
          const float px = static_cast<float>(i + di) + lattice_value(seed, ci, cj);
          const float py = static_cast<float>(j + dj) + lattice_value(seed + 1U, ci, cj);
          const float distance = std::sqrt((px - u) * (px - u) + (py - v) * (py - v));
          if (distance < first) {
            second = first;
            first = distance;
            value = lattice_value(seed + 2U, ci, cj);
          } else {
            second = std::min(second, distance);
          }
        }
      }
      noise.nearest.at(x, y) = first;
      noise.second.at(x, y) = second;
      noise.value.at(x, y) = value;
    }
  }
  return noise;
}

}  // namespace rigproof
