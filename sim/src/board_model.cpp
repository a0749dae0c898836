#include "board_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mjcf_text.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr int kMaxTexels = 4096;  // a side of the texture, on any driver
constexpr std::uint8_t kDark = 25, kLight = 230;

// 256 texels magnify well down to 0.2 m; fewer where a board has many squares.
int texels_per_square(int squares) {
  int texels = 256;
  while (texels > 16 && texels * squares > kMaxTexels) texels /= 2;
  return texels;
}

struct BoxFace {
  std::array<std::array<int, 3>, 4> corners;  // each coordinate: 0 = lower, 1 = upper bound
  std::array<int, 3> normal;
};

// Corners run anticlockwise as seen from outside.
constexpr std::array<BoxFace, 6> kFaces = {{
    {{{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}}, {0, 0, -1}},
    {{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}}, {0, 0, 1}},
    {{{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}}, {0, -1, 0}},
    {{{{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}}}, {0, 1, 0}},
    {{{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}}, {-1, 0, 0}},
    {{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}}, {1, 0, 0}},
}};

}  // namespace

BoardTexture draw_board(const Board& board, double margin_m) {
  BoardTexture texture;
  texture.frame_squares = std::max(1, static_cast<int>(std::ceil(margin_m / board.square_m - 1e-9)));
  const int columns = board.squares_x + 2 * texture.frame_squares, rows = board.squares_y + 2 * texture.frame_squares;
  const int texels = texels_per_square(std::max(columns, rows));
  texture.width = columns * texels;
  texture.height = rows * texels;
  texture.rgb.assign(static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 3, kLight);
  for (int y = 0; y < texture.height; ++y) {
    const int iy = y / texels - texture.frame_squares;
    if (iy < 0 || iy >= board.squares_y) continue;
    for (int ix = 0; ix < board.squares_x; ++ix) {
      if (!Board::is_dark(ix, iy)) continue;
      const auto first = static_cast<std::ptrdiff_t>(3) *
                         (static_cast<std::ptrdiff_t>(y) * texture.width + (ix + texture.frame_squares) * texels);
      std::fill_n(texture.rgb.begin() + first, 3 * texels, kDark);
    }
  }
  return texture;
}

BoardMjcf board_mjcf(const Board& board, double margin_m, double thickness_m, const BoardTexture& texture,
                     const std::string& pose_attributes) {
  const double s = board.square_m;
  const double low[3] = {-s - margin_m, -s - margin_m, 0.0};
  const double high[3] = {s * (board.squares_x - 1) + margin_m, s * (board.squares_y - 1) + margin_m, thickness_m};
  std::string vertices, normals, coordinates, faces;
  int next = 0;
  for (const BoxFace& face : kFaces) {
    const bool front = face.normal[2] < 0;
    for (const std::array<int, 3>& corner : face.corners) {
      double p[3];
      for (std::size_t k = 0; k < 3; ++k) p[k] = corner[k] == 0 ? low[k] : high[k];
      vertices += numbers({p[0], p[1], p[2]}) + " ";
      normals += numbers({double(face.normal[0]), double(face.normal[1]), double(face.normal[2])}) + " ";
      // Sides and back show the texture's outermost texel, which is white.
      const double frame = texture.frame_squares;
      const double u = front ? (p[0] / s + 1.0 + frame) / (board.squares_x + 2.0 * frame) : 0.0;
      const double v = front ? (p[1] / s + 1.0 + frame) / (board.squares_y + 2.0 * frame) : 0.0;
      coordinates += numbers({u, v}) + " ";
    }
    for (const int k : {0, 1, 2, 0, 2, 3}) faces += std::to_string(next + k) + " ";
    next += 4;
  }
  const std::string name = quoted(kBoardName);
  BoardMjcf mjcf;
  mjcf.asset = "  <texture name=" + name + " type=\"2d\" builtin=\"flat\" width=\"" + std::to_string(texture.width) +
               "\" height=\"" + std::to_string(texture.height) + "\"/>\n  <material name=" + name + " texture=" + name +
               " specular=\"0\" shininess=\"0\" reflectance=\"0\"/>\n  <mesh name=" + name +
               " vertex=" + quoted(vertices) + " normal=" + quoted(normals) + " texcoord=" + quoted(coordinates) +
               " face=" + quoted(faces) + "/>\n";
  mjcf.body = "  <body name=" + name + " " + pose_attributes + ">\n    <geom name=" + name +
              " type=\"mesh\" mesh=" + name + " material=" + name + " contype=\"1\" conaffinity=\"1\"/>\n  </body>\n";
  return mjcf;
}

}  // namespace rigproof
