// Clean renders on disk: without loss, and never taken for what they are not.
#include "clean_cache.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <optional>

#include "rigproof/core/files.h"
#include "rigproof/core/random.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

// A floor with a box on it, sky above, and a value of every awkward kind.
CleanFrame sample_frame(int width = 97, int height = 61) {
  CleanFrame frame;
  frame.gl_renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  frame.color = Image8(width, height, 3);
  RandomStream random(1, "colors");
  for (std::uint8_t& level : frame.color.pixels) level = static_cast<std::uint8_t>(random.below(256));
  frame.depth_m = ImageF(width, height);
  for (int y = height / 3; y < height; ++y)
    for (int x = 0; x < width; ++x) frame.depth_m.at(x, y) = x > 40 && x < 60 ? 1.5F : 40.0F / static_cast<float>(y);
  frame.depth_m.at(3, 50) = std::numeric_limits<float>::infinity();
  frame.depth_m.at(4, 50) = -0.0F;
  frame.depth_m.at(5, 50) = std::numeric_limits<float>::denorm_min();
  return frame;
}

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

std::optional<CleanFrame> decoded(const std::vector<std::uint8_t>& bytes) {
  // Memory of another frame, which must not shine through.
  CleanFrame frame = sample_frame(70, 55);
  std::vector<std::uint8_t> scratch(77, 9);
  return decode_clean_frame(bytes, &scratch, &frame) ? std::optional<CleanFrame>(frame) : std::nullopt;
}

TEST(CleanCache, FramesComeBackBitByBit) {
  for (const auto& [width, height] : {std::pair{97, 61}, {1, 1}, {8, 2}, {1, 9}}) {
    const CleanFrame frame = sample_frame(width < 10 ? 97 : width, height < 10 ? 61 : height);
    const auto back = decoded(bytes_of(encode_clean_frame(frame)));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->gl_renderer, frame.gl_renderer);
    EXPECT_EQ(back->color.pixels, frame.color.pixels);
    EXPECT_EQ(back->color.width, frame.color.width);
    ASSERT_EQ(back->depth_m.pixels.size(), frame.depth_m.pixels.size());
    EXPECT_EQ(std::memcmp(back->depth_m.pixels.data(), frame.depth_m.pixels.data(), 4 * frame.depth_m.pixels.size()),
              0);
  }
}

TEST(CleanCache, TinyAndDepthlessFramesComeBack) {
  for (const auto& [width, height] : {std::pair{1, 1}, {8, 2}, {1, 9}}) {
    CleanFrame frame;
    frame.color = Image8(width, height, 3, 7);
    const auto back = decoded(bytes_of(encode_clean_frame(frame)));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->color.pixels, frame.color.pixels);
    EXPECT_TRUE(back->depth_m.empty());
  }
}

TEST(CleanCache, SmoothDepthTakesLittleSpace) {
  CleanFrame frame = sample_frame(640, 480);
  frame.color = Image8(640, 480, 3, 100);
  EXPECT_LT(encode_clean_frame(frame).size(), frame.depth_m.pixels.size());  // a quarter of its bytes
}

TEST(CleanCache, DamagedFramesAreNotThere) {
  const std::vector<std::uint8_t> good = bytes_of(encode_clean_frame(sample_frame()));
  for (std::size_t i = 0; i < good.size(); i += 1 + good.size() / 199) {
    std::vector<std::uint8_t> bad = good;
    bad[i] = static_cast<std::uint8_t>(bad[i] ^ 0x10U);
    const auto frame = decoded(bad);
    // Sizes in the header are part of what has to fit; the pixels are under a checksum.
    EXPECT_FALSE(frame && frame->color.pixels != sample_frame().color.pixels) << i;
    EXPECT_FALSE(decoded({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)})) << i;
  }
}

TEST(CleanCache, KeepsFramesUnderTheirKeys) {
  const TempFolder folder;
  const CleanCache cache(folder.path() / "cache");
  const std::string key(64, 'a'), other(64, 'b');
  CleanFrame frame;
  EXPECT_FALSE(cache.load(key, &frame));
  EXPECT_EQ(cache.renderer_of(key), "");
  cache.save(key, sample_frame());
  EXPECT_TRUE(cache.load(key, &frame));
  EXPECT_EQ(cache.renderer_of(key), sample_frame().gl_renderer);
  EXPECT_FALSE(cache.load(other, &frame));
  write_file_atomically(cache.file_of(key), std::string_view("not a frame"));
  EXPECT_FALSE(cache.load(key, &frame));
  EXPECT_EQ(cache.renderer_of(key), "");
}

}  // namespace
}  // namespace rigproof
