#include "marker_reading.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "marker_codes.h"
#include "rigproof/calib/geometry/homography.h"
#include "rigproof/core/board_markers.h"

namespace rigproof::detection {
namespace {

using Eigen::MatrixXf;
using Eigen::Vector2d;
using Eigen::Vector2i;
using Eigen::VectorXf;

// Blur of lens and pixel that a marker is compared through [px].
constexpr double kBlurPx = 0.7;
// A place needs this evidence, more where more squares could agree by chance, and this much more than any other. With
// one to two less of each, none of 3,000 boards in squares of 5 to 8 px was read as either of two others, in noise or
// in pictures as cameras process them; with four less two were.
constexpr double kEvidence = 12.0, kEvidencePerRoot = 0.5, kEvidenceAhead = 6.0;
// A marker is read where its correlation is above this; of the squares between corners that were found, this share.
constexpr float kRead = 0.2F;
constexpr double kShareRead = 0.75;
// These squares alone have this evidence, and this correlation in the mean: beyond them may be anything.
constexpr double kEvidenceBetweenCorners = 8.0, kMeanCorrelation = 0.45;

/// What is seen in a square of the grid that may hold a marker.
struct SeenSquare {
  int i, j;
  bool whole;     ///< all four corners were found
  MatrixXf grey;  ///< of the cells of its marker's bits, rows along j
};

// The four turns: the board's x and y as steps in (i, j).
struct Turn {
  Vector2i x, y;
};
const std::array<Turn, 4>& turns() {
  static const std::array<Turn, 4> all = {{{{1, 0}, {0, 1}}, {{0, 1}, {-1, 0}}, {{-1, 0}, {0, -1}}, {{0, -1}, {1, 0}}}};
  return all;
}

/// Which squares of a grid hold the board's markers, and where lines of its corners lie from each other [squares].
struct GridScale {
  bool has_tags = false;
  int tag_i = 0, tag_j = 0;  ///< parity of the first corner of tags
  double tag = 1.0;          ///< side of a tag

  double along(int i, int parity) const {
    if (!has_tags) return i;
    const int in_cell = (i - parity) & 1;
    return (i - parity - in_cell) / 2 + in_cell * tag;
  }
  Vector2d place(int i, int j) const { return {along(i, tag_i), along(j, tag_j)}; }
  bool holds_marker(const CornerGrid& grid, int i, int j) const {
    if (!has_tags) return !grid.is_dark(i, j);
    return ((i - tag_i) & 1) == 0 && ((j - tag_j) & 1) == 0;
  }
};

// Mean lengths of the steps along an axis that begin at an even and at an odd place; 0: none.
std::array<double, 2> step_lengths(const CornerGrid& grid, int di, int dj) {
  std::array<double, 2> sum{}, count{};
  for (const auto& [at, pixel] : grid.corners) {
    const auto next = grid.corners.find({at.first + di, at.second + dj});
    if (next == grid.corners.end()) continue;
    const auto parity = static_cast<std::size_t>((di == 1 ? at.first : at.second) & 1);
    sum[parity] += (next->second - pixel).norm();
    ++count[parity];
  }
  return {sum[0] / std::max(count[0], 1.0), sum[1] / std::max(count[1], 1.0)};
}

int longer_steps(const CornerGrid& grid, int di, int dj) {
  const std::array<double, 2> lengths = step_lengths(grid, di, dj);
  return lengths[1] > lengths[0] ? 1 : 0;
}

// Absent where tags would be light.
std::optional<GridScale> scale_of(const CornerGrid& grid, const Board& board) {
  GridScale scale;
  if (!board.has_tags()) return scale;
  scale = {true, longer_steps(grid, 1, 0), longer_steps(grid, 0, 1), board.marker_side_m() / board.square_m};
  return grid.is_dark(scale.tag_i, scale.tag_j) ? std::optional(scale) : std::nullopt;
}

// From grid coordinates to the image, and for each square as its own corners say.
class GridMap {
 public:
  GridMap(const CornerGrid& grid, const GridScale& scale, const Homography& H) : grid_(grid), scale_(scale), H_(H) {}

  /// Where a square's corners are; those not found by the homography of all, moved as the found ones are.
  std::optional<Homography> square(int i, int j, int* found) const {
    std::array<PlanePoint, 4> points;
    std::array<bool, 4> seen{};
    Vector2d shift = Vector2d::Zero();
    *found = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int di = k == 1 || k == 2, dj = k >= 2;
      points[k].board = Vector2d(di, dj);
      if (!H_.map(scale_.place(i + di, j + dj), &points[k].pixel)) return std::nullopt;
      const auto corner = grid_.corners.find({i + di, j + dj});
      if (corner == grid_.corners.end()) continue;
      seen[k] = true;
      ++*found;
      shift += corner->second - points[k].pixel;
      points[k].pixel = corner->second;
    }
    if (*found < 2) return std::nullopt;
    for (std::size_t k = 0; k < 4; ++k)
      if (!seen[k]) points[k].pixel += shift / *found;
    return Homography::fit({points.begin(), points.end()});
  }

 private:
  const CornerGrid& grid_;
  const GridScale& scale_;
  const Homography& H_;
};

std::optional<Homography> homography_of(const CornerGrid& grid, const GridScale& scale) {
  std::vector<PlanePoint> points;
  for (const auto& [at, pixel] : grid.corners) points.push_back({scale.place(at.first, at.second), pixel});
  return Homography::fit(points);
}

// Bilinear; false outside of the image.
bool sample(const Image8& grey, const Vector2d& at, float* value) {
  if (!(at.minCoeff() >= 0.0) || at.x() >= grey.width - 1 || at.y() >= grey.height - 1) return false;
  const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
  const auto fx = static_cast<float>(at.x() - x), fy = static_cast<float>(at.y() - y);
  const auto row = [&](int line) {
    const auto a = static_cast<float>(grey.at(x, line)), b = static_cast<float>(grey.at(x + 1, line));
    return a + fx * (b - a);
  };
  const float top = row(y), bottom = row(y + 1);
  *value = top + fy * (bottom - top);
  return true;
}

/// How a marker lies in its square.
struct MarkerShape {
  int bits, border;
  double share;  ///< its side over the square's

  double cell() const { return share / (bits + 2 * border); }
};

// Mean grey of each cell of a square's marker, by nine samples; absent where the image ends.
std::optional<MatrixXf> cells_of(const Image8& grey, const Homography& square, const MarkerShape& shape) {
  const int bits = shape.bits;
  MatrixXf cells = MatrixXf::Zero(bits, bits);
  const double cell = shape.cell(), begin = 0.5 * (1.0 - shape.share) + shape.border * cell;
  for (int y = 0; y < bits; ++y)
    for (int x = 0; x < bits; ++x)
      for (int k = 0; k < 9; ++k) {
        const Vector2d in_cell(x + 0.5 + 0.25 * (k % 3 - 1), y + 0.5 + 0.25 * (k / 3 - 1));
        Vector2d pixel;
        float value = 0.0F;
        if (!square.map(Vector2d::Constant(begin) + cell * in_cell, &pixel) || !sample(grey, pixel, &value))
          return std::nullopt;
        cells(y, x) += value / 9.0F;
      }
  return cells;
}

// Without its mean and of unit length; zero where there is nothing but noise.
VectorXf normalised(const MatrixXf& cells) {
  constexpr float kLeastRms = 1.5F;  // [grey levels]
  VectorXf v = Eigen::Map<const VectorXf>(cells.data(), cells.size());
  v.array() -= v.mean();
  const float norm = v.norm();
  if (norm < kLeastRms * std::sqrt(static_cast<float>(v.size()))) return VectorXf::Zero(v.size());
  return v / norm;
}

// Weights of cells at whole distances under a Gaussian blur.
MatrixXf blur_matrix(int from, int size, int all, double sigma_cells) {
  const double sigma = std::hypot(sigma_cells, 0.2);  // of the samples themselves
  MatrixXf weights(size, all);
  const auto below = [sigma](double x) { return 0.5 * (1.0 + std::erf(x / (sigma * std::sqrt(2.0)))); };
  for (int r = 0; r < size; ++r)
    for (int c = 0; c < all; ++c) {
      const double d = c - (from + r);
      weights(r, c) = static_cast<float>(below(d + 0.5) - below(d - 0.5));
    }
  return weights;
}

// How many independent numbers a row of cells counts for that are blurred so much.
double independent_of(int bits, double sigma_cells) {
  const MatrixXf blur = blur_matrix(3, bits, bits + 6, sigma_cells);
  const MatrixXf shared = blur * blur.transpose();
  return static_cast<double>(shared.trace() * shared.trace() / shared.squaredNorm());
}

// A marker's picture as it lies in the grid: turned, blurred, its bits alone.
VectorXf expected(const MatrixXf& picture, int bits, const Turn& turn, const Vector2d& cell_px) {
  const auto size = static_cast<int>(picture.rows());
  const double middle = 0.5 * (size - 1);
  MatrixXf turned(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Vector2d g(i - middle, j - middle);
      const double x = turn.x.cast<double>().dot(g) + middle, y = turn.y.cast<double>().dot(g) + middle;
      turned(j, i) = picture(static_cast<Eigen::Index>(std::lround(y)), static_cast<Eigen::Index>(std::lround(x)));
    }
  const MatrixXf along_j = blur_matrix(3, bits, size, kBlurPx / cell_px.y());
  const MatrixXf along_i = blur_matrix(3, bits, size, kBlurPx / cell_px.x());
  return normalised(255.0F * along_j * turned * along_i.transpose());
}

struct Seen {
  std::vector<SeenSquare> squares;
  Vector2d square_px = Vector2d::Zero();  ///< their mean sides along i and j
};

Seen marked_squares(const Image8& grey, const CornerGrid& grid, const GridScale& scale, const MarkerShape& shape) {
  Seen seen;
  const std::optional<Homography> H = homography_of(grid, scale);
  if (!H) return seen;
  const GridMap map(grid, scale, *H);
  for (int j = grid.j_min - 1; j <= grid.j_max; ++j)
    for (int i = grid.i_min - 1; i <= grid.i_max; ++i) {
      if (!scale.holds_marker(grid, i, j)) continue;
      int found = 0;
      const std::optional<Homography> square = map.square(i, j, &found);
      if (!square) continue;
      std::optional<MatrixXf> cells = cells_of(grey, *square, shape);
      if (!cells) continue;
      const Eigen::Matrix2d side = square->jacobian({0.5, 0.5});
      const double area = std::abs(side.determinant());
      seen.square_px += Vector2d(area / side.col(1).norm(), area / side.col(0).norm());
      seen.squares.push_back({i, j, found == 4, std::move(*cells)});
    }
  seen.square_px /= static_cast<double>(std::max<std::size_t>(seen.squares.size(), 1));
  return seen;
}

/// Where the board could lie, and what speaks for it.
struct Place {
  double evidence = 0.0, of_whole = 0.0;  ///< of all squares; of those between corners that were found
  double correlation = 0.0;               ///< sum over the latter
  int squares = 0, whole = 0, read = 0;   ///< that hold markers; of whole ones those that were read
};
using PlaceKey = std::tuple<int, int, int, int>;  // turn, i and j of corner 0; of tags in their places

// Where corner 0 is if the square (ix, iy) of the board is the square (i, j) of the grid.
PlaceKey key_of(int turn, int of_tags, const SeenSquare& square, const BoardMarker& marker) {
  const Turn& t = turns()[static_cast<std::size_t>(turn)];
  // The square's middle is at (ix - 1/2, iy - 1/2) from corner 0; everything twice, to stay with whole numbers.
  const Vector2i middle2 = Vector2i(2 * square.i + 1, 2 * square.j + 1);
  const Vector2i corner2 = middle2 - (2 * marker.ix - 1) * t.x - (2 * marker.iy - 1) * t.y;
  return {turn, corner2.x() / 2, corner2.y() / 2, of_tags};
}

// Of a correlation of `n` independent numbers: the logarithm of how much likelier it is than none.
double evidence_of(float correlation, double n) {
  const double r = std::min(std::abs(static_cast<double>(correlation)), 0.98);
  const double gain = -0.5 * std::max(n - 1.0, 0.0) * std::log(1.0 - r * r);
  return correlation < 0.0F ? -gain : gain;
}

using Places = std::map<PlaceKey, Place>;

Places places_of(const Seen& seen, const Board& board, const std::vector<MatrixXf>& pictures,
                 const MarkerShape& shape) {
  const std::vector<BoardMarker> markers = markers_of(board);
  const Vector2d cell_px = seen.square_px * shape.cell();
  // Of cells smaller than the blur each is much as its neighbours.
  const double independent =
      independent_of(shape.bits, kBlurPx / cell_px.x()) * independent_of(shape.bits, kBlurPx / cell_px.y());
  std::vector<VectorXf> shown;
  for (const SeenSquare& square : seen.squares) shown.push_back(normalised(square.grey));
  Places places;
  for (int turn = 0; turn < 4; ++turn)
    for (const BoardMarker& marker : markers) {
      const VectorXf picture = expected(pictures[static_cast<std::size_t>(marker.id)], shape.bits,
                                        turns()[static_cast<std::size_t>(turn)], cell_px);
      for (std::size_t k = 0; k < shown.size(); ++k) {
        const float correlation = shown[k].dot(picture);
        const double evidence = evidence_of(correlation, independent);
        for (int of_tags = 0; of_tags < (board.has_tags() ? 4 : 1); ++of_tags) {
          Place& place = places[key_of((turn + of_tags) % 4, of_tags, seen.squares[k], marker)];
          place.evidence += evidence;
          ++place.squares;
          if (!seen.squares[k].whole) continue;
          ++place.whole;
          place.of_whole += evidence;
          place.correlation += static_cast<double>(correlation);
          place.read += correlation > kRead;
        }
      }
    }
  return places;
}

// The likeliest, if it is far ahead and its markers can be read.
std::optional<std::pair<PlaceKey, double>> decide(const Places& places, int whole_squares) {
  const auto less = [](const auto& a, const auto& b) { return a.second.evidence < b.second.evidence; };
  const auto best = std::max_element(places.begin(), places.end(), less);
  if (best == places.end()) return std::nullopt;
  double second = 0.0;
  for (auto other = places.begin(); other != places.end(); ++other)
    if (other != best) second = std::max(second, other->second.evidence);
  const Place& place = best->second;
  const bool sure = place.evidence >= kEvidence + kEvidencePerRoot * std::sqrt(place.squares) &&
                    place.evidence >= second + kEvidenceAhead && place.read >= kShareRead * whole_squares &&
                    place.of_whole >= kEvidenceBetweenCorners && place.correlation >= kMeanCorrelation * place.whole;
  return sure ? std::optional(std::pair(best->first, place.evidence)) : std::nullopt;
}

BoardPlacement placement_at(const CornerGrid& grid, const Board& board, const PlaceKey& key) {
  const auto [turn, i0, j0, of_tags] = key;
  const Turn& t = turns()[static_cast<std::size_t>(turn)];
  BoardPlacement placement;
  for (int id = 0; id < board.corner_count(); ++id) {
    const int x = id % board.inner_corners_x(), y = id / board.inner_corners_x();
    const Vector2i at = Vector2i(i0, j0) + x * t.x + y * t.y;
    const auto found = grid.corners.find({at.x(), at.y()});
    if (found != grid.corners.end()) placement.seeds.emplace_back(id, found->second);
  }
  return placement;
}

}  // namespace

MarkerReader::MarkerReader(const Board& board) : board_(board) {
  const MarkerDictionary& dictionary = dictionary_of(board);
  bits_ = dictionary.bits;
  const auto count = static_cast<int>(markers_of(board).size());
  for (const int border : board.has_tags() ? std::vector{2, 1} : std::vector{1})
    pictures_.emplace_back(border, marker_pictures(dictionary, count, border));
}

template <typename Take>
void MarkerReader::for_each_border(const Image8& grey, const CornerGrid& grid, const Take& take) const {
  const std::optional<GridScale> scale = scale_of(grid, board_);
  if (!scale) return;
  for (const auto& [border, pictures] : pictures_) {
    const MarkerShape shape{bits_, border, board_.has_tags() ? 1.0 : board_.marker_side_m() / board_.square_m};
    const Seen seen = marked_squares(grey, grid, *scale, shape);
    take(border, seen, places_of(seen, board_, pictures, shape));
  }
}

MarkerReading MarkerReader::read(const Image8& grey, const CornerGrid& grid) const {
  MarkerReading reading;
  std::optional<MarkedPlacement>& best = reading.placement;
  for_each_border(grey, grid, [&](int border, const Seen& seen, const Places& places) {
    for (const auto& [key, place] : places) reading.most_evidence = std::max(reading.most_evidence, place.evidence);
    const auto whole =
        std::count_if(seen.squares.begin(), seen.squares.end(), [](const auto& one) { return one.whole; });
    const auto place = decide(places, static_cast<int>(whole));
    if (!place || (best && best->evidence >= place->second)) return;
    best = MarkedPlacement{placement_at(grid, board_, place->first), place->second};
    best->placement.tag_border_bits = border;
  });
  return reading;
}

std::optional<double> tag_share(const CornerGrid& grid) {
  constexpr double kLeastShare = 0.6;  // squares of one size have a half
  double sum = 0.0;
  for (const auto& [di, dj] : {std::pair(1, 0), std::pair(0, 1)}) {
    const std::array<double, 2> lengths = step_lengths(grid, di, dj);
    if (std::min(lengths[0], lengths[1]) <= 0.0) return std::nullopt;
    const double share = std::max(lengths[0], lengths[1]) / (lengths[0] + lengths[1]);
    if (share < kLeastShare) return std::nullopt;
    sum += share;
  }
  return 0.5 * sum;
}

}  // namespace rigproof::detection
