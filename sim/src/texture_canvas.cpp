#include "texture_canvas.h"

namespace rigproof {

void modulate(Canvas* canvas, const NoiseField& noise, float strength) {
  const float amount = strength * canvas->contrast;
  canvas->shade([&](int x, int y, const Rgb& c) { return std::max(0.1F, 1.0F + amount * noise.at(x, y)) * c; });
}

void draw_grid(Canvas* canvas, const Grid& grid, int salt) {
  const float width = static_cast<float>(canvas->size) / static_cast<float>(grid.columns);
  const float height = static_cast<float>(canvas->size) / static_cast<float>(grid.rows);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int j = static_cast<int>(static_cast<float>(y) / height);
    const float offset = grid.staggered && j % 2 == 1 ? 0.5F * width : 0.0F;
    const float along = std::fmod(static_cast<float>(x) + offset, static_cast<float>(canvas->size));
    const int i = static_cast<int>(along / width);
    const float inside_x = along - static_cast<float>(i) * width,
                inside_y = static_cast<float>(y) - static_cast<float>(j) * height;
    if (inside_x < grid.joint || inside_y < grid.joint) return canvas->second;
    const float brightness = 2.0F * lattice_value(canvas->seed(salt), i, j) - 1.0F;
    const float share = grid.second_tint * lattice_value(canvas->seed(salt + 1), i, j);
    return (1.0F + grid.tint * canvas->contrast * brightness) * mix(c, canvas->second, share);
  });
}

void sprinkle(Canvas* canvas, int salt, int cells, float density, float radius, float strength) {
  const CellularNoise noise = canvas->cellular(salt, cells);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float value = noise.value.at(x, y);
    if (value > density || noise.nearest.at(x, y) > radius) return c;
    const float sign = value < 0.5F * density ? 1.0F : -1.0F;
    return std::max(0.0F, 1.0F + sign * strength * canvas->contrast) * c;
  });
}

}  // namespace rigproof
