// Stereo: no depth in blocks of 8x8 pixels that have too little texture for matching beyond the projector's reach, and
// in those that are saturated.
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

constexpr int kBlock = 8;
// A block whose darkest pixel is this bright shows nothing to match.
constexpr int kSaturated = 254;

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

void remove_textureless(const Image8& color, double min_contrast_levels, double reach_m, ImageF* depth_m) {
  if (color.width != depth_m->width || color.height != depth_m->height) return;
  std::vector<BlockLook> blocks;
  for (int y0 = 0; y0 < color.height; y0 += kBlock) {
    const int y1 = std::min(y0 + kBlock, color.height);
    blocks.assign(static_cast<std::size_t>(color.width / kBlock), BlockLook());
    for (int y = y0; y < y1; ++y) look_at_row(color, y, &blocks);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const bool saturated = blocks[b].darkest >= kSaturated;
      const bool plain = blocks[b].brightest - blocks[b].darkest < min_contrast_levels;
      if (saturated || plain) empty_block(static_cast<int>(b), y0, y1, saturated ? 0.0 : reach_m, depth_m);
    }
  }
}

class TextureHoles final : public ClonedEffect<DepthEffect, TextureHoles> {
 public:
  void visit_switch(FieldVisitor& visitor) override {
    visitor.field("texture_holes", on_,
                  "stereo: no depth without texture, beyond the projector's reach, and where pixels are saturated");
  }
  void visit_strength(FieldVisitor& visitor) override {
    visitor.field(
        "min_contrast_levels", min_contrast_levels_, {0.0, 255.0},
        "stereo: texture that 8x8 pixels need where the projector does not reach, largest minus smallest level");
    visitor.field("projector_reach_m", reach_m_, {0.0, 1000.0}, "the pattern gives texture up to here, indoors");
    visitor.field("projector_reach_outdoors_m", reach_outdoors_m_, {0.0, 1000.0}, "the same in daylight");
  }
  bool resolve(const DepthDevice& device, DeviceDraws* /*draws*/) override {
    if (device.outdoors) reach_m_ = reach_outdoors_m_;
    return on_ && device.sensing.is_stereo() && min_contrast_levels_ > 0.0;
  }
  void label(Labels* labels) const override { (*labels)["min_contrast_levels"] = min_contrast_levels_; }
  bool changes_scene() const override { return true; }
  void change_scene(const Scene& scene, ImageF* depth_m) const override {
    remove_textureless(scene.color, min_contrast_levels_, reach_m_, depth_m);
  }

 private:
  bool on_ = true;
  double min_contrast_levels_ = 6.0, reach_m_ = 5.0, reach_outdoors_m_ = 1.0;
};

}  // namespace

std::unique_ptr<DepthEffect> texture_holes_effect() { return std::make_unique<TextureHoles>(); }

}  // namespace rigproof
