#include "board_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "board_surface.h"
#include "mjcf_text.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/sim/board_pattern.h"

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

// Strips of a bowed face: a bow of a centimetre over half a metre departs from them by less than 0.01 mm.
constexpr int kBowStrips = 48;

using Point = std::array<double, 3>;

// A mesh of quadrangles with a normal and a texture coordinate at each corner, as MJCF's attributes.
class MeshText {
 public:
  struct Corner {
    Point position, normal;
    double u = 0.0, v = 0.0;
  };

  /// Corners run anticlockwise as seen from outside.
  void add(const std::array<Corner, 4>& corners) {
    for (const Corner& corner : corners) {
      vertices_ += numbers({corner.position[0], corner.position[1], corner.position[2]}) + " ";
      normals_ += numbers({corner.normal[0], corner.normal[1], corner.normal[2]}) + " ";
      coordinates_ += numbers({corner.u, corner.v}) + " ";
    }
    for (const int k : {0, 1, 2, 0, 2, 3}) faces_ += std::to_string(next_ + k) + " ";
    next_ += 4;
  }

  std::string attributes() const {
    return "vertex=" + quoted(vertices_) + " normal=" + quoted(normals_) + " texcoord=" + quoted(coordinates_) +
           " face=" + quoted(faces_);
  }

 private:
  std::string vertices_, normals_, coordinates_, faces_;
  int next_ = 0;
};

// The plate: printed face towards -z, bent about board y, and the sides and the flat back behind it. Sides and back
// show the texture's outermost texel, which is white.
class Plate {
 public:
  Plate(const Board& board, double margin_m, double thickness_m, double frame, const BoardDefects& defects)
      : board_(board),
        thickness_m_(thickness_m),
        frame_(frame),
        first_(first_corner_m(board) / board.square_m),
        defects_(defects) {
    low_ = {board.along(-1) - margin_m, board.along(-1) - margin_m};
    high_ = {board.along(board.inner_corners_x()) + margin_m, board.along(board.inner_corners_y()) + margin_m};
  }

  std::string mesh() const {
    MeshText mesh;
    const int strips = defects_.bow_m != 0.0 ? kBowStrips : 1;
    const auto edges = [&](int i) { return std::array<double, 2>{x(i, strips), x(i + 1, strips)}; };
    const std::vector<double> columns = face_columns(strips), rows = face_rows();
    for (std::size_t i = 0; i + 1 < columns.size(); ++i) {
      const double a = columns[i], b = columns[i + 1];
      for (std::size_t j = 0; j + 1 < rows.size(); ++j)
        mesh.add({front(a, rows[j]), front(a, rows[j + 1]), front(b, rows[j + 1]), front(b, rows[j])});
    }
    const Point behind = {0.0, 0.0, 1.0}, left = {-1.0, 0.0, 0.0}, right = {1.0, 0.0, 0.0};
    const Point up = {0.0, -1.0, 0.0}, down = {0.0, 1.0, 0.0};
    mesh.add({side(low_[0], low_[1], true, behind), side(high_[0], low_[1], true, behind),
              side(high_[0], high_[1], true, behind), side(low_[0], high_[1], true, behind)});
    for (int i = 0; i < strips; ++i) {
      const auto [a, b] = edges(i);
      mesh.add({side(a, low_[1], false, up), side(b, low_[1], false, up), side(b, low_[1], true, up),
                side(a, low_[1], true, up)});
    }
    for (int i = 0; i < strips; ++i) {
      const auto [a, b] = edges(i);
      mesh.add({side(a, high_[1], false, down), side(a, high_[1], true, down), side(b, high_[1], true, down),
                side(b, high_[1], false, down)});
    }
    mesh.add({side(low_[0], low_[1], false, left), side(low_[0], low_[1], true, left),
              side(low_[0], high_[1], true, left), side(low_[0], high_[1], false, left)});
    mesh.add({side(high_[0], low_[1], false, right), side(high_[0], high_[1], false, right),
              side(high_[0], high_[1], true, right), side(high_[0], low_[1], true, right)});
    return mesh.attributes();
  }

  Eigen::Vector3d corner(int id) const {
    const Eigen::Vector3d nominal = board_.corner(id);
    const Point p = front(nominal.x(), nominal.y()).position;
    return {p[0], p[1], p[2]};
  }

 private:
  // Where the printed face is cut along x: at the strips of a bow, and at corners that have moved.
  std::vector<double> face_columns(int strips) const {
    std::vector<double> cuts;
    for (int i = 0; i <= strips; ++i) cuts.push_back(x(i, strips));
    if (!defects_.corner_shifts_m.empty())
      for (int i = 0; i < board_.inner_corners_x(); ++i) cuts.push_back(board_.along(i));
    std::sort(cuts.begin(), cuts.end());
    return cuts;
  }
  std::vector<double> face_rows() const {
    std::vector<double> cuts = {low_[1], high_[1]};
    if (!defects_.corner_shifts_m.empty())
      for (int i = 0; i < board_.inner_corners_y(); ++i) cuts.push_back(board_.along(i));
    std::sort(cuts.begin(), cuts.end());
    return cuts;
  }

  // Shift of a place of the print, between the corners around it; beyond the outermost ones it is theirs.
  Eigen::Vector2d shift(double px, double py) const {
    if (defects_.corner_shifts_m.empty()) return Eigen::Vector2d::Zero();
    const int nx = board_.inner_corners_x(), ny = board_.inner_corners_y();
    const double u = std::clamp(among_corners(px), 0.0, nx - 1.0), v = std::clamp(among_corners(py), 0.0, ny - 1.0);
    const int i = std::min(static_cast<int>(u), std::max(0, nx - 2)),
              j = std::min(static_cast<int>(v), std::max(0, ny - 2));
    const auto at = [&](int ix, int iy) -> const Eigen::Vector2d& {
      return defects_.corner_shifts_m[static_cast<std::size_t>(std::min(iy, ny - 1) * nx + std::min(ix, nx - 1))];
    };
    const double s = u - i, t = v - j;
    return (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j)) +
           t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
  }

  // How many lines of corners a place lies beyond the first one.
  double among_corners(double p) const {
    if (!board_.has_tags()) return p / board_.square_m;
    const int i = 2 * static_cast<int>(std::floor(p / board_.square_m));
    const int before = p < board_.along(i + 1) ? i : i + 1;
    return before + (p - board_.along(before)) / (board_.along(before + 1) - board_.along(before));
  }

  double x(int i, int count) const { return i == count ? high_[0] : low_[0] + (high_[0] - low_[0]) * i / count; }

  Point place(double px, double py, double z) const {
    const Eigen::Vector3d c = board_.centre();
    return {defects_.print_scale_x == 1.0 ? px : c.x() + defects_.print_scale_x * (px - c.x()),
            defects_.print_scale_y == 1.0 ? py : c.y() + defects_.print_scale_y * (py - c.y()), z};
  }

  // -1 to 1 from one edge to the other.
  double across(double px) const { return (2.0 * px - low_[0] - high_[0]) / (high_[0] - low_[0]); }
  double bow(double px) const {
    return defects_.bow_m == 0.0 ? 0.0 : -defects_.bow_m * (1.0 - across(px) * across(px));
  }

  MeshText::Corner front(double px, double py) const {
    const double slope = defects_.bow_m * 4.0 * across(px) / ((high_[0] - low_[0]) * defects_.print_scale_x);
    const double length = std::hypot(slope, 1.0);
    const Eigen::Vector2d moved = shift(px, py);
    Point position = place(px, py, bow(px));
    if (!defects_.corner_shifts_m.empty()) position = {position[0] + moved.x(), position[1] + moved.y(), position[2]};
    return {position,
            {slope / length, 0.0, -1.0 / length},
            (px / board_.square_m + first_ + frame_) / (board_.squares_x + 2.0 * frame_),
            (py / board_.square_m + first_ + frame_) / (board_.squares_y + 2.0 * frame_)};
  }

  MeshText::Corner side(double px, double py, bool back, const Point& normal) const {
    return {place(px, py, back ? thickness_m_ : bow(px)), normal, 0.0, 0.0};
  }

  const Board& board_;
  double thickness_m_, frame_;
  double first_;  ///< squares before corner 0
  const BoardDefects& defects_;
  std::array<double, 2> low_{}, high_{};
};

void fill_squares(const Board& board, int texels, BoardTexture* texture) {
  for (int y = 0; y < texture->height; ++y) {
    const int iy = y / texels - texture->frame_squares;
    if (iy < 0 || iy >= board.squares_y) continue;
    for (int ix = 0; ix < board.squares_x; ++ix) {
      if (!board.is_dark(ix, iy)) continue;
      const auto first = static_cast<std::ptrdiff_t>(3) *
                         (static_cast<std::ptrdiff_t>(y) * texture->width + (ix + texture->frame_squares) * texels);
      std::fill_n(texture->rgb.begin() + first, 3 * texels, kDark);
    }
  }
}

// Areas that end amid texels darken them by the share that they cover.
void fill_areas(const Board& board, int texels, BoardTexture* texture) {
  const double per_m = texels / board.square_m,
               origin = texels * (texture->frame_squares + first_corner_m(board) / board.square_m);
  const auto share = [](double from, double to, int texel) {
    return std::max(0.0, std::min(to, texel + 1.0) - std::max(from, static_cast<double>(texel)));
  };
  std::vector<float> cover(static_cast<std::size_t>(texture->width) * static_cast<std::size_t>(texture->height));
  for (const DarkArea& area : dark_areas(board)) {
    const double x0 = std::max(0.0, origin + area.x0_m * per_m), y0 = std::max(0.0, origin + area.y0_m * per_m);
    const double x1 = std::min<double>(texture->width, origin + area.x1_m * per_m);
    const double y1 = std::min<double>(texture->height, origin + area.y1_m * per_m);
    for (int y = static_cast<int>(y0); y < y1; ++y)
      for (int x = static_cast<int>(x0); x < x1; ++x)
        cover[static_cast<std::size_t>(y) * static_cast<std::size_t>(texture->width) + static_cast<std::size_t>(x)] +=
            static_cast<float>(share(x0, x1, x) * share(y0, y1, y));
  }
  for (std::size_t i = 0; i < cover.size(); ++i) {
    const double level = kLight + std::min(1.0F, cover[i]) * (kDark - kLight);
    std::fill_n(texture->rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                static_cast<std::uint8_t>(std::lround(level)));
  }
}

}  // namespace

BoardTexture draw_board(const Board& board, double margin_m, const BoardDefects& defects) {
  BoardTexture texture;
  texture.frame_squares =
      std::max(1, static_cast<int>(std::ceil((margin_m + overhang_m(board)) / board.square_m - 1e-9)));
  const int columns = board.squares_x + 2 * texture.frame_squares, rows = board.squares_y + 2 * texture.frame_squares;
  const int texels = texels_per_square(std::max(columns, rows));
  texture.width = columns * texels;
  texture.height = rows * texels;
  texture.rgb.assign(static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 3, kLight);
  (board.type == "checkerboard" ? fill_squares : fill_areas)(board, texels, &texture);
  if (defects.on_surface()) soil(board, margin_m, defects, &texture);
  return texture;
}

std::vector<Eigen::Vector3d> printed_corners(const Board& board, double margin_m, const BoardDefects& defects) {
  const Plate plate(board, margin_m, 0.0, 1.0, defects);
  std::vector<Eigen::Vector3d> corners;
  for (int id = 0; id < board.corner_count(); ++id) corners.push_back(plate.corner(id));
  return corners;
}

std::string board_name(std::size_t index) {
  return index == 0 ? kBoardName : kBoardName + ("_" + std::to_string(index + 1));
}

std::optional<std::size_t> board_of_name(const std::string& name) {
  constexpr std::size_t kMost = 8;  // `board`, and seven `more_boards`
  for (std::size_t i = 0; i < kMost; ++i)
    if (name == board_name(i)) return i;
  return std::nullopt;
}

BoardMjcf board_mjcf(const WorldBoard& board, const BoardTexture& texture, const std::string& called,
                     const std::string& pose_attributes) {
  const Plate plate(board.board, board.board_margin_m, board.board_thickness_m, texture.frame_squares,
                    board.board_defects);
  const std::string name = quoted(called);
  BoardMjcf mjcf;
  mjcf.asset = "  <texture name=" + name + " type=\"2d\" builtin=\"flat\" width=\"" + std::to_string(texture.width) +
               "\" height=\"" + std::to_string(texture.height) + "\"/>\n  <material name=" + name + " texture=" + name +
               " specular=\"0\" shininess=\"0\" reflectance=\"0\"/>\n  <mesh name=" + name + " " + plate.mesh() +
               "/>\n";
  mjcf.body = "  <body name=" + name + " " + pose_attributes + ">\n    <geom name=" + name +
              " type=\"mesh\" mesh=" + name + " material=" + name + " contype=\"1\" conaffinity=\"1\"/>\n  </body>\n";
  return mjcf;
}

}  // namespace rigproof
