#include "board_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

constexpr std::array<double, 3> kDirtColor = {74.0, 62.0, 48.0};
constexpr std::array<double, 3> kClothColor = {96.0, 104.0, 122.0};
constexpr int kMostSpots = 120;

// The sheet in texels.
struct Sheet {
  double left, top, width, height, texels_per_m;
};

class Painter {
 public:
  Painter(const Sheet& sheet, BoardTexture* texture) : sheet_(sheet), texture_(texture) {}

  // Mixes a colour in with opacity(x, y) at every texel of the sheet's part; x, y in texels from the sheet's corner.
  template <typename Opacity>
  void mix(double x0, double y0, double x1, double y1, const std::array<double, 3>& color, const Opacity& opacity) {
    const int left = clamp(sheet_.left + x0, texture_->width), right = clamp(sheet_.left + x1 + 1.0, texture_->width);
    const int top = clamp(sheet_.top + y0, texture_->height), bottom = clamp(sheet_.top + y1 + 1.0, texture_->height);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const double a = opacity(x + 0.5 - sheet_.left, y + 0.5 - sheet_.top);
        if (a <= 0.0) continue;
        std::uint8_t* texel =
            texture_->rgb.data() +
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(texture_->width) + static_cast<std::size_t>(x));
        for (std::size_t k = 0; k < 3; ++k)
          texel[k] = static_cast<std::uint8_t>(std::lround(texel[k] + std::min(a, 1.0) * (color[k] - texel[k])));
      }
  }

  const Sheet& sheet() const { return sheet_; }

 private:
  static int clamp(double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  }

  Sheet sheet_;
  BoardTexture* texture_;
};

void add_dirt(double dirt, RandomStream random, Painter* painter) {
  const Sheet& sheet = painter->sheet();
  const int count = static_cast<int>(std::lround(kMostSpots * dirt));
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(0.0, sheet.width), y = random.uniform(0.0, sheet.height);
    // Many specks, few smudges.
    const double radius = sheet.texels_per_m * 0.002 * std::exp(random.uniform(0.0, 2.2));
    const double stretch = random.uniform(1.0, 3.0), angle = random.uniform(0.0, kPi);
    const double strength = random.uniform(0.25, 0.8);
    const double reach = 2.5 * radius * stretch;
    painter->mix(x - reach, y - reach, x + reach, y + reach, kDirtColor, [&](double u, double v) {
      const double along = (std::cos(angle) * (u - x) + std::sin(angle) * (v - y)) / (radius * stretch);
      const double across = (-std::sin(angle) * (u - x) + std::cos(angle) * (v - y)) / radius;
      return strength * std::exp(-0.5 * (along * along + across * across));
    });
  }
}

// A triangle over one corner whose area is the share, with a hem of a texel.
void add_cloth(double share, RandomStream random, Painter* painter) {
  const Sheet& sheet = painter->sheet();
  const double ratio = std::exp2(random.uniform(-0.4, 0.4));
  const double a = sheet.width * std::sqrt(2.0 * share * ratio), b = sheet.height * std::sqrt(2.0 * share / ratio);
  const bool right = random.below(2) == 1, bottom = random.below(2) == 1;
  const double edge = std::hypot(1.0 / a, 1.0 / b);
  painter->mix(0.0, 0.0, sheet.width, sheet.height, kClothColor, [&](double u, double v) {
    const double x = right ? sheet.width - u : u, y = bottom ? sheet.height - v : v;
    return 0.5 + (1.0 - x / a - y / b) / edge;
  });
}

void add_glare(double glare, RandomStream random, Painter* painter) {
  const Sheet& sheet = painter->sheet();
  const double x = random.uniform(0.15, 0.85) * sheet.width, y = random.uniform(0.15, 0.85) * sheet.height;
  const double size = random.uniform(0.10, 0.22) * std::hypot(sheet.width, sheet.height);
  const double stretch = random.uniform(1.0, 2.0);
  painter->mix(0.0, 0.0, sheet.width, sheet.height, {255.0, 255.0, 255.0}, [&](double u, double v) {
    const double dx = (u - x) / (size * stretch), dy = (v - y) / size;
    return glare * std::exp(-0.5 * (dx * dx + dy * dy));
  });
}

}  // namespace

void soil(const Board& board, double margin_m, const BoardDefects& defects, BoardTexture* texture) {
  const double texels_per_m = texture->width / (board.square_m * (board.squares_x + 2 * texture->frame_squares));
  const double inset = (board.square_m * texture->frame_squares - overhang_m(board) - margin_m) * texels_per_m;
  Painter painter({inset, inset, texture->width - 2.0 * inset, texture->height - 2.0 * inset, texels_per_m}, texture);
  if (defects.dirt > 0.0) add_dirt(defects.dirt, RandomStream(defects.seed, "board dirt"), &painter);
  if (defects.glare > 0.0) add_glare(defects.glare, RandomStream(defects.seed, "board glare"), &painter);
  if (defects.covered > 0.0) add_cloth(defects.covered, RandomStream(defects.seed, "board cloth"), &painter);
}

}  // namespace rigproof
