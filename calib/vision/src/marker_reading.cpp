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
// A place needs this evidence, more where more squares could agree by chance, and this much more than any other.
constexpr double kEvidence = 15.0, kEvidencePerRoot = 1.5, kEvidenceAhead = 8.0;
// A marker is read where its correlation is above this; of the squares between corners that were found, this share.
constexpr float kRead = 0.2F;
constexpr double kShareRead = 0.75;
// These squares alone have this evidence, and this correlation in the mean: beyond them may be anything.
constexpr double kEvidenceBetweenCorners = 12.0, kMeanCorrelation = 0.45;

/// What is seen in a light square of the grid.
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

// From grid coordinates to the image, and for each square as its own corners say.
class GridMap {
 public:
  GridMap(const CornerGrid& grid, const Homography& H) : grid_(grid), H_(H) {}

  /// Where a square's corners are; those not found by the homography of all, moved as the found ones are.
  std::optional<Homography> square(int i, int j, int* found) const {
    std::array<PlanePoint, 4> points;
    std::array<bool, 4> seen{};
    Vector2d shift = Vector2d::Zero();
    *found = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int di = k == 1 || k == 2, dj = k >= 2;
      points[k].board = Vector2d(di, dj);
      if (!H_.map(Vector2d(i + di, j + dj), &points[k].pixel)) return std::nullopt;
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
  const Homography& H_;
};

std::optional<Homography> homography_of(const CornerGrid& grid) {
  std::vector<PlanePoint> points;
  for (const auto& [at, pixel] : grid.corners) points.push_back({Vector2d(at.first, at.second), pixel});
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

// Mean grey of each cell of a square's marker, by nine samples; absent where the image ends.
std::optional<MatrixXf> cells_of(const Image8& grey, const Homography& square, int bits, double marker_share) {
  MatrixXf cells = MatrixXf::Zero(bits, bits);
  const double cell = marker_share / (bits + 2), begin = 0.5 * (1.0 - marker_share) + cell;
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

Seen light_squares(const Image8& grey, const CornerGrid& grid, int bits, double marker_share) {
  Seen seen;
  const std::optional<Homography> H = homography_of(grid);
  if (!H) return seen;
  const GridMap map(grid, *H);
  for (int j = grid.j_min - 1; j <= grid.j_max; ++j)
    for (int i = grid.i_min - 1; i <= grid.i_max; ++i) {
      if (grid.is_dark(i, j)) continue;
      int found = 0;
      const std::optional<Homography> square = map.square(i, j, &found);
      if (!square) continue;
      std::optional<MatrixXf> cells = cells_of(grey, *square, bits, marker_share);
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
using PlaceKey = std::tuple<int, int, int>;  // turn, i and j of corner 0

// Where corner 0 is if the square (ix, iy) of the board is the square (i, j) of the grid.
PlaceKey key_of(int turn, const SeenSquare& square, const BoardMarker& marker) {
  const Turn& t = turns()[static_cast<std::size_t>(turn)];
  // The square's middle is at (ix - 1/2, iy - 1/2) from corner 0; everything twice, to stay with whole numbers.
  const Vector2i middle2 = Vector2i(2 * square.i + 1, 2 * square.j + 1);
  const Vector2i corner2 = middle2 - (2 * marker.ix - 1) * t.x - (2 * marker.iy - 1) * t.y;
  return {turn, corner2.x() / 2, corner2.y() / 2};
}

// Of a correlation of `n` numbers: the logarithm of how much likelier it is than none.
double evidence_of(float correlation, Eigen::Index n) {
  const double r = std::min(std::abs(static_cast<double>(correlation)), 0.98);
  const double gain = -0.5 * static_cast<double>(n - 1) * std::log(1.0 - r * r);
  return correlation < 0.0F ? -gain : gain;
}

using Places = std::map<PlaceKey, Place>;

Places places_of(const Seen& seen, const Board& board, const std::vector<MatrixXf>& pictures, int bits) {
  const std::vector<BoardMarker> markers = charuco_markers(board);
  const Vector2d cell_px = seen.square_px * (board.marker_side_m() / board.square_m / (bits + 2));
  std::vector<VectorXf> shown;
  for (const SeenSquare& square : seen.squares) shown.push_back(normalised(square.grey));
  Places places;
  for (int turn = 0; turn < 4; ++turn)
    for (const BoardMarker& marker : markers) {
      const VectorXf picture = expected(pictures[static_cast<std::size_t>(marker.id)], bits,
                                        turns()[static_cast<std::size_t>(turn)], cell_px);
      for (std::size_t k = 0; k < shown.size(); ++k) {
        Place& place = places[key_of(turn, seen.squares[k], marker)];
        const float correlation = shown[k].dot(picture);
        const double evidence = evidence_of(correlation, picture.size());
        place.evidence += evidence;
        ++place.squares;
        if (!seen.squares[k].whole) continue;
        ++place.whole;
        place.of_whole += evidence;
        place.correlation += static_cast<double>(correlation);
        place.read += correlation > kRead;
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
  const auto [turn, i0, j0] = key;
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
  pictures_ = marker_pictures(dictionary, static_cast<int>(charuco_markers(board).size()));
}

std::optional<MarkedPlacement> MarkerReader::read(const Image8& grey, const CornerGrid& grid) const {
  const Seen seen = light_squares(grey, grid, bits_, board_.marker_side_m() / board_.square_m);
  if (seen.squares.empty()) return std::nullopt;
  const auto whole = std::count_if(seen.squares.begin(), seen.squares.end(), [](const auto& one) { return one.whole; });
  const auto place = decide(places_of(seen, board_, pictures_, bits_), static_cast<int>(whole));
  if (!place) return std::nullopt;
  return MarkedPlacement{placement_at(grid, board_, place->first), place->second};
}

}  // namespace rigproof::detection
