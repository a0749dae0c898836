#include "textures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "board_model.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

SceneTexture texture_of(const std::string& type) {
  SceneTexture texture;
  texture.name = "t";
  texture.type = type;
  texture.size_px = 128;
  return texture;
}

double deviation(const std::vector<std::uint8_t>& rgb) {
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t value : rgb) {
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  const double count = static_cast<double>(rgb.size());
  return std::sqrt(squares / count - sum / count * (sum / count));
}

TEST(Textures, EveryTypeIsDeterministicSeededAndTextured) {
  for (const std::string& type : texture_types()) {
    if (type == "file") continue;
    const SceneTexture texture = texture_of(type);
    const std::vector<std::uint8_t> rgb = draw_texture(texture, 1);
    ASSERT_EQ(rgb.size(), 3U * 128U * 128U) << type;
    EXPECT_EQ(rgb, draw_texture(texture, 1)) << type;
    EXPECT_NE(rgb, draw_texture(texture, 2)) << type;
    EXPECT_GT(deviation(rgb), type == "plain" ? 1.0 : 2.5) << type;  // grey levels: something to find features on
  }
}

TEST(Textures, NamesSeparateTheirPatterns) {
  SceneTexture one = texture_of("gravel"), other = one;
  other.name = "u";
  EXPECT_NE(draw_texture(one, 1), draw_texture(other, 1));
}

TEST(Textures, RepeatWithoutSeams) {
  // The step across the border is no larger than the largest step inside.
  const SceneTexture texture = texture_of("concrete");
  const std::vector<std::uint8_t> rgb = draw_texture(texture, 3);
  const auto at = [&](int x, int y) { return static_cast<int>(rgb[static_cast<std::size_t>(3 * (y * 128 + x))]); };
  double inside = 0.0, across = 0.0;
  for (int y = 0; y < 128; ++y) {
    across += std::abs(at(127, y) - at(0, y)) / 128.0;
    for (int x = 0; x < 127; ++x) inside += std::abs(at(x + 1, y) - at(x, y)) / (128.0 * 127.0);
  }
  EXPECT_LT(across, 2.0 * inside);
}

TEST(BoardTexture, KeepsEdgesOnTexelsAtEveryLevel) {
  Board board;
  board.squares_x = 6;
  board.squares_y = 5;
  const BoardTexture texture = draw_board(board, 0.05);
  const int texels = texture.width / (board.squares_x + 2 * texture.frame_squares);
  EXPECT_EQ(texture.height, texels * (board.squares_y + 2 * texture.frame_squares));
  EXPECT_EQ(texels & (texels - 1), 0);
  EXPECT_GE(texels, 64);
  // The square outside of corner 0 is dark, its neighbour light.
  const auto at = [&](int ix, int iy) {
    const int x = (ix + texture.frame_squares) * texels, y = (iy + texture.frame_squares) * texels;
    return texture.rgb[static_cast<std::size_t>(3 * (y * texture.width + x))];
  };
  EXPECT_LT(at(0, 0), 60);
  EXPECT_GT(at(1, 0), 180);
  EXPECT_GT(at(-1, 0), 180);
}

TEST(BoardTexture, ManySquaresStayWithinTheDriversLimit) {
  Board board;
  board.squares_x = 60;
  board.squares_y = 40;
  const BoardTexture texture = draw_board(board, 0.0);
  EXPECT_LE(texture.width, 4096);
}

}  // namespace
}  // namespace rigproof
