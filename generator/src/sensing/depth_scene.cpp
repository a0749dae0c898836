#include "depth_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "normals.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

constexpr int kBlock = 8;
constexpr int kEdgeReach = 2;
// A block whose darkest pixel is this bright shows nothing to match.
constexpr int kSaturated = 254;

float inverse(float z) { return z > 0.0F ? 1.0F / z : 0.0F; }

RIGPROOF_VECTOR_CLONES
void invert_row(const float* depth, std::size_t width, float factor, float* out) {
  for (std::size_t x = 0; x < width; ++x) {
    const float z = depth[x];
    out[x] = z > 0.0F ? factor / z : 0.0F;
  }
}

RIGPROOF_VECTOR_CLONES
void mark_edges(const float* above, const float* here, const float* below, std::size_t width, float step,
                std::uint8_t* edge) {
  edge[0] = edge[width - 1] = 0;
  for (std::size_t x = 1; x + 1 < width; ++x) {
    const float across = std::abs(here[x - 1] - 2.0F * here[x] + here[x + 1]);
    const float down = std::abs(above[x] - 2.0F * here[x] + below[x]);
    edge[x] = static_cast<std::uint8_t>((across > step) | (down > step));
  }
}

// Marks what lies within kEdgeReach of an edge, row and column apart.
Image8 edge_zone(const ImageF& clean, double step_per_m) {
  const auto width = static_cast<std::size_t>(clean.width);
  Image8 zone(clean.width, clean.height);
  if (clean.width < 3 || clean.height < 3) return zone;
  std::array<std::vector<float>, 3> rows;
  for (std::vector<float>& row : rows) row.resize(width);
  std::vector<std::uint8_t> edge(width);
  invert_row(clean.row(0), width, 1.0F, rows[0].data());
  invert_row(clean.row(1), width, 1.0F, rows[1].data());
  for (int y = 1; y + 1 < clean.height; ++y) {
    const auto row = [&](int i) { return rows[static_cast<std::size_t>((y + i) % 3)].data(); };
    invert_row(clean.row(y + 1), width, 1.0F, row(1));
    mark_edges(row(-1), row(0), row(1), width, static_cast<float>(step_per_m), edge.data());
    for (std::size_t x = 0; x < width; ++x) {
      if (edge[x] == 0) continue;
      const int first = std::max(0, static_cast<int>(x) - kEdgeReach);
      const int last = std::min(clean.width - 1, static_cast<int>(x) + kEdgeReach);
      const int top = std::max(0, y - kEdgeReach), bottom = std::min(clean.height - 1, y + kEdgeReach);
      for (int v = top; v <= bottom; ++v) std::fill(zone.row(v) + first, zone.row(v) + last + 1, std::uint8_t{1});
    }
  }
  return zone;
}

float clamped_depth(const ImageF& depth, int x, int y) {
  return depth.at(std::clamp(x, 0, depth.width - 1), std::clamp(y, 0, depth.height - 1));
}

float edge_depth(const ImageF& clean, const DepthSensing& model, int x, int y, RandomStream* random) {
  const std::vector<float>& normals = normal_table();
  const std::uint32_t places = random->next_u32(), mix = random->next_u32();
  const auto jitter = [&](std::uint32_t bits) {
    return static_cast<int>(std::lround(model.edge_jitter_px * static_cast<double>(normals[bits & 0xFFFU])));
  };
  const float here = clamped_depth(clean, x + jitter(places), y + jitter(places >> 12U));
  const double draw = static_cast<double>(mix & 0xFFFFU) / 65536.0;
  if (draw >= model.flying_share) return here;
  constexpr std::uint32_t kSide = 2 * kEdgeReach + 1;
  const auto beside = [](std::uint32_t bits) { return static_cast<int>(bits % kSide) - kEdgeReach; };
  const float other = clamped_depth(clean, x + beside((mix >> 16U) & 0x0FU), y + beside((mix >> 20U) & 0x0FU));
  if (here <= 0.0F || other <= 0.0F) return here;
  const float share = (static_cast<float>(mix >> 24U) + 0.5F) / 256.0F;
  return 1.0F / (inverse(here) + share * (inverse(other) - inverse(here)));
}

struct BlockLook {
  int darkest = 255, brightest = 0;
};

// Of the green channel, which weighs most in what an imager sees.
void look_at_row(const Image8& color, int y, std::vector<BlockLook>* blocks) {
  const std::uint8_t* pixel = color.row(y) + (color.channels > 1 ? 1 : 0);
  const int whole = color.width / kBlock;
  for (int b = 0; b < whole; ++b) {
    BlockLook& block = (*blocks)[static_cast<std::size_t>(b)];
    int darkest = block.darkest, brightest = block.brightest;
    for (int i = 0; i < kBlock; ++i, pixel += color.channels) {
      darkest = std::min(darkest, static_cast<int>(*pixel));
      brightest = std::max(brightest, static_cast<int>(*pixel));
    }
    block = {darkest, brightest};
  }
}

void empty_block(int block_x, int y0, int y1, double reach_m, ImageF* depth_m) {
  for (int y = y0; y < y1; ++y) {
    float* depth = depth_m->row(y) + static_cast<std::ptrdiff_t>(block_x) * kBlock;
    for (int i = 0; i < kBlock; ++i)
      if (static_cast<double>(depth[i]) > reach_m) depth[i] = 0.0F;
  }
}

}  // namespace

void remove_hidden(const ImageF& clean, double focal_px, double offset_m, ImageF* depth_m) {
  const auto width = static_cast<std::size_t>(clean.width);
  std::vector<float> shift(width);
  // Mirrored for an imager on the left, so that both are scanned the same way: from the side of the imager, a point is
  // hidden if one that was passed before already covers its place or a place beyond.
  const bool right = offset_m > 0.0;
  const auto factor = static_cast<float>(focal_px * std::abs(offset_m));
  for (int y = 0; y < clean.height; ++y) {
    invert_row(clean.row(y), width, factor, shift.data());
    float* out = depth_m->row(y);
    float covered = 2.0F * static_cast<float>(width);
    for (std::size_t i = 0; i < width; ++i) {
      const std::size_t x = right ? width - 1 - i : i;
      const float place = static_cast<float>(width - 1 - i) - shift[x];
      if (place >= covered)
        out[x] = 0.0F;
      else
        covered = place;
    }
  }
}

void blur_edges(const ImageF& clean, const DepthSensing& model, RandomStream random, ImageF* depth_m) {
  const Image8 zone = edge_zone(clean, model.edge_step_per_m);
  for (int y = 0; y < clean.height; ++y) {
    const std::uint8_t* marked = zone.row(y);
    float* out = depth_m->row(y);
    for (int x = 0; x < clean.width; ++x)
      if (marked[x] != 0) out[x] = edge_depth(clean, model, x, y, &random);
  }
}

void remove_textureless(const Image8& color, const DepthSensing& model, ImageF* depth_m) {
  if (color.width != depth_m->width || color.height != depth_m->height) return;
  std::vector<BlockLook> blocks;
  for (int y0 = 0; y0 < color.height; y0 += kBlock) {
    const int y1 = std::min(y0 + kBlock, color.height);
    blocks.assign(static_cast<std::size_t>(color.width / kBlock), BlockLook());
    for (int y = y0; y < y1; ++y) look_at_row(color, y, &blocks);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const bool saturated = blocks[b].darkest >= kSaturated;
      const bool plain = blocks[b].brightest - blocks[b].darkest < model.min_contrast_levels;
      if (saturated || plain)
        empty_block(static_cast<int>(b), y0, y1, saturated ? 0.0 : model.projector_reach_m, depth_m);
    }
  }
}

void shift_image(int shift_x, int shift_y, ImageF* depth_m) {
  ImageF moved(depth_m->width, depth_m->height);
  const int width = depth_m->width - std::abs(shift_x);
  for (int y = 0; y < depth_m->height && width > 0; ++y) {
    const int source = y - shift_y;
    if (source < 0 || source >= depth_m->height) continue;
    std::copy_n(depth_m->row(source) + std::max(0, -shift_x), width, moved.row(y) + std::max(0, shift_x));
  }
  depth_m->pixels.swap(moved.pixels);
}

}  // namespace rigproof
