// Plain materials: walls, ground, furniture.
#include "texture_canvas.h"

namespace rigproof {
namespace {

void draw_plain(Canvas* canvas) { modulate(canvas, canvas->noise(1, 4, 4, 5), 0.02F); }

void draw_plaster(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 3, 3, 4), 0.035F);
  modulate(canvas, canvas->noise(2, 64, 64, 3), 0.035F);
  const NoiseField stains = canvas->noise(3, 5, 5, 5);
  canvas->shade([&](int x, int y, const Rgb& c) {
    return mix(c, canvas->second, 0.35F * std::clamp(stains.at(x, y) - 1.2F, 0.0F, 1.0F) * canvas->contrast);
  });
}

void draw_vinyl(Canvas* canvas) {
  draw_grid(canvas, {canvas->cells(4), canvas->cells(4), false, 2.0F, 0.06F, 0.0F}, 10);
  sprinkle(canvas, 20, 190, 0.7F, 0.45F, 0.13F);
  sprinkle(canvas, 30, 110, 0.35F, 0.42F, 0.17F);
  modulate(canvas, canvas->noise(1, 6, 6, 4), 0.03F);
}

void draw_concrete(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 3, 3, 6, 0.6F), 0.10F);
  modulate(canvas, canvas->noise(2, 128, 128, 2), 0.06F);
  const CellularNoise cracks = canvas->cellular(3, 5);
  const NoiseField where = canvas->noise(4, 3, 3, 3);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float edge = cracks.second.at(x, y) - cracks.nearest.at(x, y);
    return edge < 0.012F && where.at(x, y) > 0.3F ? mix(c, canvas->second, 0.8F) : c;
  });
  sprinkle(canvas, 20, 90, 0.25F, 0.2F, 0.35F);
}

void draw_brick(Canvas* canvas) {
  draw_grid(canvas,
            {canvas->cells(6), canvas->cells(18), true, 0.006F * static_cast<float>(canvas->size), 0.22F, 0.25F}, 10);
  modulate(canvas, canvas->noise(1, 48, 48, 4), 0.09F);
  modulate(canvas, canvas->noise(2, 3, 3, 3), 0.06F);
}

void draw_planks(Canvas* canvas) {
  draw_grid(canvas, {canvas->cells(2), canvas->cells(12), true, 2.0F, 0.16F, 0.2F}, 10);
  modulate(canvas, canvas->noise(1, 4, 96, 4), 0.10F);
  sprinkle(canvas, 20, 16, 0.25F, 0.12F, -0.45F);
}

void draw_wood(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 3, 48, 5, 0.6F), 0.14F);
  modulate(canvas, canvas->noise(2, 6, 160, 2), 0.06F);
}

void draw_asphalt(Canvas* canvas) {
  const CellularNoise stones = canvas->cellular(1, 230);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float value = stones.value.at(x, y);
    const float stone = 0.7F + 0.55F * value * value;
    return std::max(0.2F, 1.0F + canvas->contrast * (stone - 0.88F)) * c;
  });
  modulate(canvas, canvas->noise(2, 3, 3, 5, 0.6F), 0.10F);
  const NoiseField patches = canvas->noise(3, 2, 2, 4);
  canvas->shade(
      [&](int x, int y, const Rgb& c) { return patches.at(x, y) > 1.1F ? mix(c, canvas->second, 0.45F) : c; });
}

void draw_gravel(Canvas* canvas) {
  const CellularNoise stones = canvas->cellular(1, 70);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float edge = std::clamp((stones.second.at(x, y) - stones.nearest.at(x, y)) * 4.0F, 0.0F, 1.0F);
    const Rgb stone = (0.6F + 0.8F * stones.value.at(x, y)) * c;
    return mix(canvas->second, stone, edge);
  });
  modulate(canvas, canvas->noise(2, 200, 200, 2), 0.08F);
  modulate(canvas, canvas->noise(3, 4, 4, 3), 0.06F);
}

void draw_grass(Canvas* canvas) {
  const NoiseField blades = canvas->noise(1, 220, 60, 2), across = canvas->noise(2, 60, 220, 2);
  const NoiseField patches = canvas->noise(3, 5, 5, 5);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float blade = std::max(blades.at(x, y), across.at(x, y));
    const Rgb base = mix(c, canvas->second, std::clamp(0.5F + 0.45F * patches.at(x, y), 0.0F, 1.0F));
    return std::max(0.25F, 1.0F + 0.22F * canvas->contrast * blade) * base;
  });
}

void draw_metal(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 2, 256, 2), 0.05F);
  sprinkle(canvas, 20, 20, 0.2F, 0.1F, 0.2F);
  const NoiseField rust = canvas->noise(2, 5, 5, 6, 0.6F);
  canvas->shade(
      [&](int x, int y, const Rgb& c) { return mix(c, canvas->second, std::clamp(rust.at(x, y) - 1.4F, 0.0F, 0.8F)); });
}

void draw_cardboard(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 4, 160, 2), 0.03F);
  modulate(canvas, canvas->noise(2, 4, 4, 4), 0.05F);
  const int tape = canvas->size / 2, half = canvas->size / 24;
  canvas->shade([&](int x, int y, const Rgb& c) {
    if (std::abs(y - tape) < half) return mix(c, canvas->second, 0.7F);
    const bool label =
        x > canvas->size / 8 && x < 3 * canvas->size / 8 && y > canvas->size / 8 && y < 3 * canvas->size / 8;
    if (!label) return c;
    const bool ink = lattice_value(canvas->seed(5), 24 * x / canvas->size * 2, 24 * y / canvas->size) > 0.55F;
    return ink ? Rgb{0.15F, 0.15F, 0.17F} : Rgb{0.9F, 0.9F, 0.88F};
  });
}

// Rectangles of random colour and lines that look like print: posters, notices, screens, book spines.
void draw_poster(Canvas* canvas) {
  RandomStream random(canvas->seed(7), "poster");
  const auto pixel = [&](double share) { return static_cast<int>(share * canvas->size); };
  for (int i = 0; i < 14; ++i) {
    const int x0 = pixel(random.uniform(0.0, 0.8)), y0 = pixel(random.uniform(0.0, 0.8));
    const int x1 = x0 + pixel(random.uniform(0.08, 0.45)), y1 = y0 + pixel(random.uniform(0.05, 0.3));
    const auto level = [&] { return static_cast<float>(random.uniform(0.1, 0.95)); };
    const Rgb color = mix({level(), level(), level()}, i % 3 == 0 ? canvas->second : canvas->main, 0.35F);
    const bool print = random.uniform() < 0.4;
    const int line = std::max(2, pixel(0.012));
    for (int y = y0; y < std::min(y1, canvas->size); ++y)
      for (int x = x0; x < std::min(x1, canvas->size); ++x) {
        const bool ink = y / line % 2 == 0 && lattice_value(canvas->seed(i), x / line, y / line) > 0.3F;
        if (!print || ink) canvas->at(x, y) = color;
      }
  }
  modulate(canvas, canvas->noise(1, 8, 8, 3), 0.02F);
}

void draw_foliage(Canvas* canvas) {
  const CellularNoise leaves = canvas->cellular(1, 40);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float value = leaves.value.at(x, y), shadow = std::clamp(1.3F - leaves.nearest.at(x, y), 0.3F, 1.0F);
    return shadow * mix(c, canvas->second, value);
  });
  modulate(canvas, canvas->noise(2, 60, 60, 3), 0.18F);
}

void draw_stripes(Canvas* canvas) {
  const int count = canvas->cells(6);
  canvas->shade(
      [&](int x, int y, const Rgb& c) { return ((x + y) * count / canvas->size) % 2 == 0 ? c : canvas->second; });
  modulate(canvas, canvas->noise(1, 8, 8, 5), 0.08F);
}

}  // namespace

const Painters& material_painters() {
  static const Painters all = {
      {"asphalt", draw_asphalt}, {"brick", draw_brick},   {"cardboard", draw_cardboard}, {"concrete", draw_concrete},
      {"foliage", draw_foliage}, {"grass", draw_grass},   {"gravel", draw_gravel},       {"metal", draw_metal},
      {"plain", draw_plain},     {"planks", draw_planks}, {"plaster", draw_plaster},     {"poster", draw_poster},
      {"stripes", draw_stripes}, {"vinyl", draw_vinyl},   {"wood", draw_wood},
  };
  return all;
}

}  // namespace rigproof
