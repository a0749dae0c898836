// Ground and faces under the sky.
#include "texture_canvas.h"

namespace rigproof {
namespace {

// Grass with bare soil (the second color) and flowers.
void draw_meadow(Canvas* canvas) {
  const NoiseField blades = canvas->noise(1, 240, 70, 2), across = canvas->noise(2, 70, 240, 2);
  const NoiseField patches = canvas->noise(3, 4, 4, 5), soil = canvas->noise(4, 6, 6, 6, 0.6F);
  const NoiseField clumps = canvas->noise(6, 34, 34, 3);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float blade = std::max(blades.at(x, y), across.at(x, y));
    const Rgb dry{0.72F, 0.68F, 0.36F};
    const Rgb green = mix(c, dry, std::clamp(0.22F + 0.2F * patches.at(x, y), 0.0F, 0.6F));
    const float bare = std::clamp(2.0F * (soil.at(x, y) - 1.1F), 0.0F, 0.9F);
    const float light = 1.0F + canvas->contrast * (0.24F * blade + 0.13F * clumps.at(x, y));
    return std::max(0.25F, light) * mix(green, canvas->second, bare);
  });
  const CellularNoise flowers = canvas->cellular(5, 60);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float value = flowers.value.at(x, y);
    if (value > 0.22F || flowers.nearest.at(x, y) > 0.16F) return c;
    return value < 0.11F ? Rgb{0.93F, 0.86F, 0.25F} : Rgb{0.92F, 0.91F, 0.88F};
  });
}

// Old asphalt: stones, cracks, mended strips, oil.
void draw_worn_asphalt(Canvas* canvas) {
  const CellularNoise stones = canvas->cellular(1, 330);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float value = stones.value.at(x, y);
    return std::max(0.2F, 1.0F + canvas->contrast * (0.55F * value * value - 0.18F)) * c;
  });
  modulate(canvas, canvas->noise(2, 3, 3, 5, 0.6F), 0.08F);
  const CellularNoise plates = canvas->cellular(3, 4);
  const NoiseField crumble = canvas->noise(4, 40, 40, 4), where = canvas->noise(5, 3, 3, 3);
  const NoiseField oil = canvas->noise(6, 5, 5, 4);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float edge = plates.second.at(x, y) - plates.nearest.at(x, y) + 0.012F * crumble.at(x, y);
    if (edge < 0.014F && where.at(x, y) > -0.7F) return 0.35F * c;
    if (edge < 0.05F && where.at(x, y) > 0.9F) return mix(c, canvas->second, 0.75F);
    return oil.at(x, y) > 2.1F ? mix(c, canvas->second, 0.6F) : c;
  });
}

// Stones of many sizes and colors.
void draw_pebbles(Canvas* canvas) {
  const CellularNoise fine = canvas->cellular(1, 150), coarse = canvas->cellular(2, 46);
  const Rgb warm = mix(canvas->main, {0.75F, 0.58F, 0.42F}, 0.35F),
            cold = mix(canvas->main, {0.5F, 0.55F, 0.62F}, 0.5F);
  const auto stone = [&](const CellularNoise& cells, int x, int y) {
    const float value = cells.value.at(x, y);
    const float edge = std::clamp(5.0F * (cells.second.at(x, y) - cells.nearest.at(x, y)), 0.0F, 1.0F);
    const Rgb kind = value < 0.3F ? warm : value < 0.55F ? cold : canvas->main;
    const float tone = 1.0F + canvas->contrast * (std::fmod(7.0F * value, 1.0F) - 0.55F);
    return mix(0.6F * canvas->second, tone * kind, edge);
  };
  canvas->shade([&](int x, int y, const Rgb&) {
    const bool large = coarse.value.at(x, y) > 0.55F && coarse.nearest.at(x, y) < 0.48F;
    return large ? stone(coarse, x, y) : 0.92F * stone(fine, x, y);
  });
  modulate(canvas, canvas->noise(3, 200, 200, 2), 0.07F);
  modulate(canvas, canvas->noise(4, 4, 4, 4), 0.08F);
}

// Rows of windows in a wall of the main color.
void draw_facade(Canvas* canvas) {
  const int columns = std::max(1, canvas->cells(6)), rows = std::max(1, canvas->cells(5));
  const int wide = std::max(8, canvas->size / columns), tall = std::max(8, canvas->size / rows);
  modulate(canvas, canvas->noise(1, 40, 40, 4), 0.06F);
  const NoiseField clouds = canvas->noise(2, 5, 5, 4);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int u = 100 * (x % wide) / wide, v = 100 * (y % tall) / tall;
    if (u < 16 || u > 84 || v < 22 || v > 82) return v > 82 && v < 88 ? 0.8F * c : c;
    if (u < 20 || u > 80 || v < 26 || v > 78 || std::abs(u - 50) < 2) return canvas->second;
    const float blind = lattice_value(canvas->seed(3), x / wide, y / tall);
    if (static_cast<float>(v) > 78.0F - 40.0F * blind * blind && v % 5 < 3) return Rgb{0.8F, 0.78F, 0.72F};
    const float sheen = 0.5F + 0.12F * clouds.at(x, y) + 0.004F * static_cast<float>(v);
    return sheen * Rgb{0.42F, 0.52F, 0.62F};
  });
}

// Ribbed sheet metal.
void draw_corrugated(Canvas* canvas) {
  const int ribs = std::max(1, canvas->cells(20));
  const float turn = 6.2831853F * static_cast<float>(ribs) / static_cast<float>(canvas->size);
  const NoiseField dirt = canvas->noise(1, 24, 4, 5, 0.6F), rust = canvas->noise(2, 8, 8, 6, 0.6F);
  const int sheet = std::max(2, canvas->size / 2);
  canvas->shade([&](int x, int y, const Rgb& c) {
    if (y % sheet < std::max(1, canvas->size / 200)) return 0.5F * c;
    const float rib = std::sin(turn * static_cast<float>(x));
    const Rgb steel = (1.0F + canvas->contrast * (0.22F * rib + 0.05F * dirt.at(x, y))) * c;
    return mix(steel, canvas->second, std::clamp(rust.at(x, y) - 1.3F, 0.0F, 0.8F));
  });
}

// Straw: hay, thatch.
void draw_straw(Canvas* canvas) {
  const NoiseField a = canvas->noise(1, 16, 200, 2), b = canvas->noise(2, 200, 16, 2), c3 = canvas->noise(3, 60, 90, 3);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float stalk = std::max(a.at(x, y), b.at(x, y));
    const Rgb tone = mix(c, canvas->second, std::clamp(0.4F - 0.3F * c3.at(x, y), 0.0F, 1.0F));
    return std::max(0.3F, 0.9F + 0.2F * canvas->contrast * stalk) * tone;
  });
}

}  // namespace

const Painters& outdoor_painters() {
  static const Painters all = {
      {"corrugated", draw_corrugated}, {"facade", draw_facade}, {"meadow", draw_meadow},
      {"pebbles", draw_pebbles},       {"straw", draw_straw},   {"worn_asphalt", draw_worn_asphalt},
  };
  return all;
}

}  // namespace rigproof
