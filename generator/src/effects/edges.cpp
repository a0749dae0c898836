// Frayed edges, where 1/z bends by more than a step: planes have none, however oblique. Within two pixels of an edge
// the pixel shows what is `edge_jitter_px` (one sigma) beside it, and `flying_share` of these pixels lie between that
// and another pixel of the neighbourhood, evenly in 1/z.
#include <array>
#include <cmath>

#include "../sensing/inverse_depth.h"
#include "../sensing/normals.h"
#include "rigproof/core/vector_clones.h"
#include "rigproof/generator/effect.h"

namespace rigproof {
namespace {

constexpr int kEdgeReach = 2;

float inverse(float z) { return z > 0.0F ? 1.0F / z : 0.0F; }

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

float edge_depth(const ImageF& clean, double jitter_px, double flying_share, int x, int y, RandomStream* random) {
  const std::vector<float>& normals = normal_table();
  const std::uint32_t places = random->next_u32(), mix = random->next_u32();
  const auto jitter = [&](std::uint32_t bits) {
    return static_cast<int>(std::lround(jitter_px * static_cast<double>(normals[bits & 0xFFFU])));
  };
  const float here = clamped_depth(clean, x + jitter(places), y + jitter(places >> 12U));
  const double draw = static_cast<double>(mix & 0xFFFFU) / 65536.0;
  if (draw >= flying_share) return here;
  constexpr std::uint32_t kSide = 2 * kEdgeReach + 1;
  const auto beside = [](std::uint32_t bits) { return static_cast<int>(bits % kSide) - kEdgeReach; };
  const float other = clamped_depth(clean, x + beside((mix >> 16U) & 0x0FU), y + beside((mix >> 20U) & 0x0FU));
  if (here <= 0.0F || other <= 0.0F) return here;
  const float share = (static_cast<float>(mix >> 24U) + 0.5F) / 256.0F;
  return 1.0F / (inverse(here) + share * (inverse(other) - inverse(here)));
}

class Edges final : public ClonedEffect<DepthEffect, Edges> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("edges", on_, "edges are frayed, and some pixels float between near and far");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field("edge_jitter_px", jitter_px_, {0.0, 8.0}, "lateral noise of edges, one sigma");
    visitor.field("flying_share", flying_share_, {0.0, 1.0}, "of the pixels at an edge, those that float in between");
    visitor.field("edge_step_per_m", step_per_m_, {1e-4, 10.0}, "jump of 1/z that makes an edge");
  }
  bool resolve(const DepthDevice& /*device*/, DeviceDraws* /*draws*/) override { return on_; }
  void label(Labels* labels) const override {
    (*labels)["edge_jitter_px"] = jitter_px_;
    (*labels)["flying_share"] = flying_share_;
  }
  Place place() const override { return Place::kShape; }
  bool changes_scene() const override { return true; }
  void change_scene(const Scene& scene, ImageF* depth_m) const override {
    RandomStream random = scene.frame.stream("depth edges");
    const Image8 zone = edge_zone(scene.clean_m, step_per_m_);
    for (int y = 0; y < zone.height; ++y) {
      const std::uint8_t* marked = zone.row(y);
      float* out = depth_m->row(y);
      for (int x = 0; x < zone.width; ++x)
        if (marked[x] != 0) out[x] = edge_depth(scene.clean_m, jitter_px_, flying_share_, x, y, &random);
    }
  }

 private:
  bool on_ = true;
  double jitter_px_ = 1.0, flying_share_ = 0.3, step_per_m_ = 0.02;
};

}  // namespace

std::unique_ptr<DepthEffect> edges_effect() { return std::make_unique<Edges>(); }

}  // namespace rigproof
