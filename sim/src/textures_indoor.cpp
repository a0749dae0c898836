// Floors and surfaces of rooms and halls.
#include "texture_canvas.h"

namespace rigproof {
namespace {

// Deterministic number in [0, 1) of a cell of the picture.
float dice(const Canvas& canvas, int salt, int i, int j) { return lattice_value(canvas.seed(salt), i, j); }

// Carpet tiles, laid with the pile turned from one to the next.
void draw_carpet(Canvas* canvas) {
  const int tiles = canvas->cells(4), side = std::max(1, canvas->size / tiles);
  const NoiseField along = canvas->noise(1, 20, 230, 2, 0.8F), across = canvas->noise(2, 230, 20, 2, 0.8F);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int i = x / side, j = y / side;
    const float pile = (i + j) % 2 == 0 ? along.at(x, y) : across.at(x, y);
    const float tint = 0.10F * (dice(*canvas, 3, i, j) - 0.5F);
    return std::max(0.2F, 1.0F + canvas->contrast * (0.17F * pile + tint)) * c;
  });
  const NoiseField stripes = canvas->noise(4, 3, 44, 2);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float share = std::clamp(0.8F * (stripes.at((x / side + y / side) % 2 == 0 ? x : y, y) - 0.9F), 0.0F, 0.7F);
    return mix(c, canvas->second, share);
  });
  sprinkle(canvas, 20, 150, 0.45F, 0.42F, 0.22F);
}

// Marbled ceramic tiles.
void draw_tiles(Canvas* canvas) {
  const NoiseField veins = canvas->noise(1, 5, 5, 6, 0.6F);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float vein = std::clamp(1.0F - 6.0F * std::abs(veins.at(x, y)), 0.0F, 1.0F);
    return mix(c, canvas->second, 0.35F * canvas->contrast * vein);
  });
  modulate(canvas, canvas->noise(2, 40, 40, 4), 0.045F);
  draw_grid(canvas, {canvas->cells(6), canvas->cells(6), false, 0.006F * static_cast<float>(canvas->size), 0.07F, 0.0F},
            10);
  sprinkle(canvas, 20, 130, 0.25F, 0.3F, 0.15F);
}

// Squares of four strips each, every other square turned.
void draw_parquet(Canvas* canvas) {
  constexpr int kStrips = 4;
  const int squares = 2 * std::max(1, canvas->cells(4)), side = std::max(kStrips, canvas->size / squares);
  const NoiseField along = canvas->noise(1, 6, 150, 4, 0.6F), across = canvas->noise(2, 150, 6, 4, 0.6F);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int i = x / side, j = y / side;
    const bool turned = (i + j) % 2 == 1;
    const int across_strip = turned ? x % side : y % side, strip = kStrips * across_strip / side;
    const int inside = across_strip - strip * side / kStrips;
    if (inside < 1 || (turned ? y : x) % side < 1) return 0.45F * canvas->second;
    const float tint = 0.34F * (dice(*canvas, 3 + strip, i, j) - 0.5F);
    const float grain = turned ? across.at(x, y) : along.at(x, y);
    const Rgb wood = mix(c, canvas->second, 0.4F * dice(*canvas, 9 + strip, i, j));
    return std::max(0.2F, 1.0F + canvas->contrast * (tint + 0.11F * grain)) * wood;
  });
}

// Chips of stone in cement.
void draw_terrazzo(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 60, 60, 3), 0.03F);
  for (const int cells : {170, 75}) {
    const CellularNoise chips = canvas->cellular(cells, cells);
    canvas->shade([&](int x, int y, const Rgb& c) {
      const float value = chips.value.at(x, y), edge = chips.second.at(x, y) - chips.nearest.at(x, y);
      if (value > 0.62F || edge < 0.16F || chips.nearest.at(x, y) > 0.42F) return c;
      const float level = value / 0.62F;
      const Rgb stone = level < 0.3F ? 0.35F * c : level < 0.65F ? canvas->second : 1.2F * c;
      return mix(c, stone, std::min(1.0F, 0.8F * canvas->contrast));
    });
  }
  modulate(canvas, canvas->noise(2, 3, 3, 4), 0.03F);
}

// Power-floated concrete of halls: joints, tyre marks, spilt oil.
void draw_screed(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 4, 4, 6, 0.6F), 0.075F);
  modulate(canvas, canvas->noise(2, 110, 110, 3, 0.7F), 0.07F);
  sprinkle(canvas, 20, 150, 0.35F, 0.3F, 0.22F);
  const NoiseField wander = canvas->noise(3, 3, 3, 3), worn = canvas->noise(4, 30, 30, 4);
  const NoiseField spots = canvas->noise(5, 6, 6, 4);
  const float size = static_cast<float>(canvas->size);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const float across = static_cast<float>(y) + 0.03F * size * wander.at(x, y);
    const float lane = std::fmod(across + size, 0.5F * size) / (0.5F * size);
    const bool tyre = std::abs(lane - 0.3F) < 0.045F || std::abs(lane - 0.72F) < 0.045F;
    Rgb floor = c;
    if (tyre) floor = mix(floor, canvas->second, std::clamp(0.25F + 0.2F * worn.at(x, y), 0.0F, 0.6F));
    if (spots.at(x, y) > 2.0F) floor = mix(floor, canvas->second, 0.75F);
    return floor;
  });
  const int joint = std::max(1, canvas->size / 256), half = canvas->size / 2;
  canvas->shade([&](int x, int y, const Rgb& c) { return x % half < joint || y % half < joint ? 0.55F * c : c; });
}

// A woven rug that is laid once over its geom: borders around a field that is the same in all four quarters.
void draw_rug(Canvas* canvas) {
  const NoiseField field = canvas->noise(1, 9, 9, 3), fine = canvas->noise(2, 30, 30, 2);
  const Rgb light = mix(canvas->main, {0.92F, 0.86F, 0.72F}, 0.75F), dark = 0.3F * canvas->second;
  const int size = canvas->size;
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int u = std::min(x, size - 1 - x), v = std::min(y, size - 1 - y), edge = 64 * std::min(u, v) / size;
    const float value = field.at(u, v) + field.at(v, u), detail = fine.at(u, v);
    if (edge < 1) return light;
    if (edge < 2 || edge == 8) return dark;
    if (edge < 8) return detail > 0.5F ? light : detail < -0.5F ? canvas->main : canvas->second;
    if (value > 1.5F) return light;
    if (value > 0.7F) return canvas->second;
    if (value < -1.2F) return detail > 0.0F ? dark : canvas->second;
    return c;
  });
  modulate(canvas, canvas->noise(3, 4, 256, 2), 0.08F);
  modulate(canvas, canvas->noise(4, 256, 128, 1), 0.08F);
}

// Spines of books side by side.
void draw_books(Canvas* canvas) {
  RandomStream random(canvas->seed(7), "books");
  const int size = canvas->size;
  for (int x = 0; x < size;) {
    const int end = std::min(size, x + std::max(4, static_cast<int>(size * random.uniform(0.025, 0.06))));
    const auto level = [&] { return static_cast<float>(random.uniform(0.08, 0.85)); };
    const Rgb cover = mix({level(), level(), level()}, random.uniform() < 0.5 ? canvas->main : canvas->second, 0.45F);
    const int top = static_cast<int>(size * random.uniform(0.72, 1.0));
    const int band = static_cast<int>(top * random.uniform(0.55, 0.85)), title = static_cast<int>(0.12 * size);
    for (int i = x; i < end; ++i)
      for (int y = 0; y < size; ++y) {
        const float round =
            1.0F - 0.5F * std::abs(2.0F * static_cast<float>(i - x) / static_cast<float>(end - x) - 1.0F);
        const bool ink =
            y < band && y > band - 3 * title && i > x + 2 && i < end - 3 && dice(*canvas, x, i / 3, y / 5) > 0.5F;
        const bool stripe = std::abs(y - band - title / 3) < title / 12;
        canvas->at(i, y) = y >= top ? Rgb{0.06F, 0.05F, 0.05F} : ink || stripe ? Rgb{0.85F, 0.8F, 0.6F} : round * cover;
      }
    x = end;
  }
}

// Stripes with an ornament that mirrors itself.
void draw_wallpaper(Canvas* canvas) {
  const int repeats = 2 * std::max(1, canvas->cells(3)), side = std::max(2, canvas->size / repeats);
  const NoiseField ornament = canvas->noise(1, 4 * repeats, 3 * repeats, 3);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int i = x % side, u = std::min(i, side - 1 - i);
    const float value = ornament.at(u, (y + (x / side % 2) * side / 2) % side);
    const Rgb ground = (x / side) % 2 == 0 ? c : 0.96F * c;
    return value > 0.55F ? mix(ground, canvas->second, std::min(1.0F, 0.6F * canvas->contrast)) : ground;
  });
  modulate(canvas, canvas->noise(2, 90, 90, 3), 0.03F);
}

// Perforated board with the outlines of tools.
void draw_pegboard(Canvas* canvas) {
  const int size = canvas->size, pitch = std::max(4, size / 40);
  canvas->shade([&](int x, int y, const Rgb& c) {
    const int dx = x % pitch - pitch / 2, dy = y % pitch - pitch / 2;
    return 16 * (dx * dx + dy * dy) < pitch * pitch ? 0.35F * c : c;
  });
  RandomStream random(canvas->seed(5), "tools");
  for (int i = 0; i < 22; ++i) {
    const double x0 = random.uniform(0.02, 0.92), y0 = random.uniform(0.15, 0.75), tall = random.uniform(0.08, 0.22);
    const double wide = random.uniform(0.008, 0.022), head = random.uniform(0.02, 0.06);
    const auto hue = random.below(4);
    const Rgb grip = hue == 0 ? Rgb{0.75F, 0.12F, 0.08F} : hue == 1 ? Rgb{0.85F, 0.65F, 0.1F} : Rgb{0.1F, 0.1F, 0.12F};
    const Rgb steel{0.45F, 0.47F, 0.5F};
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double u = static_cast<double>(x) / size - x0, v = static_cast<double>(y) / size - y0;
        if (v > 0.0 && v < tall && std::abs(u) < wide) canvas->at(x, y) = v < 0.5 * tall ? grip : steel;
        if (v >= tall && v < tall + 0.5 * head && std::abs(u) < head) canvas->at(x, y) = steel;
      }
  }
  modulate(canvas, canvas->noise(1, 20, 20, 3), 0.03F);
}

// Plaid cloth.
void draw_fabric(Canvas* canvas) {
  modulate(canvas, canvas->noise(1, 256, 60, 2), 0.08F);
  modulate(canvas, canvas->noise(2, 60, 256, 2), 0.08F);
  const int repeat = std::max(8, canvas->size / std::max(1, canvas->cells(5)));
  canvas->shade([&](int x, int y, const Rgb& c) {
    const auto band = [&](int at) { return at % repeat * 8 / repeat; };
    const float share = (band(x) < 2 ? 0.4F : 0.0F) + (band(y) < 2 ? 0.4F : 0.0F) + (band(x) == 5 ? 0.15F : 0.0F);
    return mix(c, canvas->second, std::min(1.0F, share * canvas->contrast));
  });
}

}  // namespace

const Painters& indoor_painters() {
  static const Painters all = {
      {"books", draw_books},         {"carpet", draw_carpet},     {"fabric", draw_fabric},
      {"parquet", draw_parquet},     {"pegboard", draw_pegboard}, {"rug", draw_rug},
      {"screed", draw_screed},       {"terrazzo", draw_terrazzo}, {"tiles", draw_tiles},
      {"wallpaper", draw_wallpaper},
  };
  return all;
}

}  // namespace rigproof
