// What procedural textures are drawn on and with: a seamless picture, seeded noise, grids and flecks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "noise.h"
#include "rigproof/core/random.h"
#include "rigproof/sim/world.h"

namespace rigproof {

struct Rgb {
  float r = 0.0F, g = 0.0F, b = 0.0F;
};

inline Rgb operator*(float s, const Rgb& c) { return {s * c.r, s * c.g, s * c.b}; }
inline Rgb operator+(const Rgb& a, const Rgb& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Rgb mix(const Rgb& a, const Rgb& b, float t) { return (1.0F - t) * a + t * b; }

inline Rgb to_rgb(const std::array<double, 3>& c) {
  return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

/// A texture while it is drawn.
class Canvas {
 public:
  Canvas(const SceneTexture& texture, std::uint64_t seed)
      : size(texture.size_px),
        main(to_rgb(texture.color)),
        second(to_rgb(texture.second_color)),
        contrast(static_cast<float>(texture.contrast)),
        seed_(RandomStream(seed, "texture " + texture.name).next_u32()),
        scale_(texture.scale),
        pixels_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), main) {}

  // Features of a type's default count, fewer when the texture is scaled up. At least one.
  int cells(int default_count) const {
    return std::clamp(static_cast<int>(std::lround(default_count / scale_)), 1, std::max(size / 2, 1));
  }
  NoiseField noise(int salt, int cells_x, int cells_y, int octaves, float gain = 0.5F) const {
    return fractal_noise(size, seed(salt), cells(cells_x), cells(cells_y), octaves, gain);
  }
  CellularNoise cellular(int salt, int default_cells) const {
    return cellular_noise(size, seed(salt), cells(default_cells));
  }
  std::uint64_t seed(int salt) const { return seed_ * 1000003ULL + static_cast<std::uint64_t>(salt) * 8191ULL; }

  Rgb& at(int x, int y) {
    return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)];
  }
  // color(x, y, current) for every pixel.
  void shade(const std::function<Rgb(int, int, const Rgb&)>& color) {
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) at(x, y) = color(x, y, at(x, y));
  }
  std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(3 * pixels_.size());
    for (const Rgb& p : pixels_)
      for (const float value : {p.r, p.g, p.b})
        rgb.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0F, 1.0F) * 255.0F + 0.5F));
    return rgb;
  }

  const int size;
  const Rgb main, second;
  const float contrast;

 private:
  std::uint64_t seed_;
  double scale_;
  std::vector<Rgb> pixels_;
};

/// Brightness follows the noise: c * (1 + strength * noise).
void modulate(Canvas* canvas, const NoiseField& noise, float strength);

/// A grid of rectangles, odd rows shifted by half if staggered, with joints in the second colour.
struct Grid {
  int columns, rows;
  bool staggered;
  float joint;        ///< width of a joint, in pixels
  float tint;         ///< strength of the random brightness of each rectangle
  float second_tint;  ///< of its random share of the second colour
};
void draw_grid(Canvas* canvas, const Grid& grid, int salt);

/// Small flecks in a random brightness, on the share `density` of the cells.
void sprinkle(Canvas* canvas, int salt, int cells, float density, float radius, float strength);

/// By the name of the type.
using Painters = std::map<std::string, void (*)(Canvas*)>;
const Painters& material_painters();  ///< what walls, ground and things are made of
const Painters& indoor_painters();    ///< floors and surfaces of rooms and halls
const Painters& outdoor_painters();   ///< ground and faces under the sky

}  // namespace rigproof
