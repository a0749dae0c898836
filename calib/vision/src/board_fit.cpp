#include "board_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

#include "bent_plane.h"
#include "marker_codes.h"
#include "rigproof/calib/geometry/homography.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/median.h"
#include "saddle_fit.h"

namespace rigproof::detection {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Squares lower than this leave too few pixels beside the edges of their neighbours [px].
constexpr double kMinSquarePx = 4.0;
// Where a first look finds fewer of its corners, an exact one shows no board either.
constexpr double kHopeless = 0.4;
// Beside a tag's edges lies its border or the gap, and nothing of its code nearer than that [px].
constexpr double kMinBorderPx = 2.5;
// Blur above this share of a square's height: neighbouring edges run into each other.
constexpr double kMaxBlurShare = 0.3;
// A corner may lie this share of a square off the homography of all; lens distortion bends the board.
constexpr double kMaxHomographyShare = 0.3;
constexpr double kMinContrastRatio = 0.35;
constexpr double kMaxBlurRatio = 2.5;
// Where a board ends, three light quadrants and a dark one leave .19 to .30 of the contrast as residual, beside the
// picture's own: in noise that is not many times the others' residual.
constexpr double kMostModelError = 0.15, kMostOfOthers = 1.5;
// Michelson's contrast of a print, glare and dim light included, is several times this; that of tartans and tiles is
// less.
constexpr double kMinPrintContrast = 0.15;
// Of a square, see disorder().
constexpr double kMaxDisorder = 0.05;
// See is_crooked(): motion blur leaves .06 and .08 of the contrast, corrugated sheets that pass for small blurred
// boards .16 to .19 and .19 to .27.
constexpr double kMaxCrookedness_rad = 0.1;

bool has_markers(const Board& board) { return board.type == "charuco" || board.has_tags(); }
double marker_share(const Board& board) {
  return board.type == "charuco" ? board.marker_side_m() / board.square_m : 0.0;
}

// Of an AprilGrid, in units of places_of_corners(): what is clean beside the edges is a tag's border or the gap, and
// along them the tag or the gap.
struct TagSides {
  double tag, gap, clean;

  TagSides(const Board& board, int border_bits) {
    const double unit = 0.5 * board.square_m, bits = dictionary_of(board).bits;
    tag = board.marker_side_m() / unit;
    gap = 2.0 - tag;
    clean = std::min(gap, border_bits / (bits + 2.0 * border_bits) * tag);
  }
};

/// The cells of a ChArUco board's markers.
class MarkerCells {
 public:
  explicit MarkerCells(const Board& board) {
    if (board.type != "charuco") return;
    const std::vector<BoardMarker> markers = markers_of(board);
    const std::vector<Eigen::MatrixXf> pictures =
        marker_pictures(dictionary_of(board), static_cast<int>(markers.size()), 1);
    for (const BoardMarker& marker : markers) {
      const Eigen::MatrixXf& light = pictures[static_cast<std::size_t>(marker.id)];
      const Eigen::Index cells = light.rows() - 4;  // a border of one, without the white around it
      dark_[{marker.ix, marker.iy}] = 1.0 - light.block(2, 2, cells, cells).cast<double>().array();
    }
  }
  /// Those of the light squares at a corner, see SaddleWindow.
  std::array<const Eigen::MatrixXd*, 2> at(int column, int row, bool dark_diagonal) const {
    return {find(column + 1, dark_diagonal ? row : row + 1), find(column, dark_diagonal ? row + 1 : row)};
  }

 private:
  const Eigen::MatrixXd* find(int ix, int iy) const {
    const auto found = dark_.find({ix, iy});
    return found == dark_.end() ? nullptr : &found->second;
  }
  std::map<std::pair<int, int>, Eigen::MatrixXd> dark_;  // by column and row of the square
};

struct MeasuredCorner {
  int id = 0;
  SaddleWindow window;
  SaddleFit fit;
};

double square_height(const Matrix2d& square) {
  return std::abs(square.determinant()) / std::max(square.col(0).norm(), square.col(1).norm());
}

template <typename Value>
double median_of(const std::vector<MeasuredCorner>& corners, Value value) {
  std::vector<double> values;
  for (const MeasuredCorner& corner : corners)
    if (corner.fit.status == SaddleStatus::kFitted) values.push_back(value(corner.fit));
  return median(std::move(values));
}

double blur_of(const SaddleFit& fit) { return fit.blur_px.maxCoeff(); }

// One step along each axis, towards the nearer (that is, shorter) neighbour.
bool square_at(const Homography& H, const Vector2d& b, const Vector2d& centre, double step, Matrix2d* square) {
  for (int axis = 0; axis < 2; ++axis) {
    Vector2d ahead, behind;
    if (!H.map(b + step * Vector2d::Unit(axis), &ahead) || !H.map(b - step * Vector2d::Unit(axis), &behind))
      return false;
    const Vector2d whole = ahead - behind;
    const double shorter = std::min((ahead - centre).norm(), (behind - centre).norm());
    square->col(axis) = shorter * whole.normalized();
  }
  return square->allFinite() && square->determinant() > 0.0;
}

std::vector<PlanePoint> points_of(const Board& board, const std::vector<MeasuredCorner>& corners) {
  std::vector<PlanePoint> points;
  for (const MeasuredCorner& corner : corners)
    if (corner.fit.status == SaddleStatus::kFitted)
      points.push_back({place_of_corner(board, corner.id), corner.fit.pixel});
  return points;
}

std::optional<Homography> homography_of(const Board& board, const std::vector<MeasuredCorner>& corners) {
  return Homography::fit(points_of(board, corners));
}

// How the edges at a corner go on: on one side of it along each axis lies a tag.
void follow_tags(const Board& board, int id, const TagSides& sides, SaddleWindow* window) {
  for (int axis = 0; axis < 2; ++axis) {
    const int line = axis == 0 ? id % board.inner_corners_x() : id / board.inner_corners_x();
    const bool tag_ahead = line % 2 == 0;
    window->clean_ahead[axis] = (tag_ahead ? sides.tag : sides.gap) / sides.clean;
    window->clean_behind[axis] = (tag_ahead ? sides.gap : sides.tag) / sides.clean;
  }
}

/// How corners are measured.
struct Measuring {
  const std::optional<TagSides>& tags;
  const MarkerCells& markers;
  const std::optional<BentPlane>& bent;  ///< of the board, where that is known
  double blur_px;
  bool coarse;
  int may_miss;  ///< after more corners that are none the others are not looked at
};

std::vector<MeasuredCorner> measure(const Image8& grey, const Board& board, const Homography& H,
                                    const std::vector<std::pair<int, Vector2d>>& seeds, const Measuring& how) {
  std::vector<MeasuredCorner> corners(static_cast<std::size_t>(board.corner_count()));
  int missed = 0;
  for (int id = 0; id < board.corner_count(); ++id) {
    MeasuredCorner& corner = corners[static_cast<std::size_t>(id)];
    corner.id = id;
    const Vector2d b = place_of_corner(board, id);
    Vector2d centre;
    if (!H.map(b, &centre) || !square_at(H, b, centre, how.tags ? how.tags->clean : 1.0, &corner.window.square))
      continue;
    if (how.tags) follow_tags(board, id, *how.tags, &corner.window);
    const auto seed = std::find_if(seeds.begin(), seeds.end(), [id](const auto& s) { return s.first == id; });
    corner.window.centre = seed != seeds.end() ? seed->second : centre;
    const int column = id % board.inner_corners_x(), row = id / board.inner_corners_x();
    corner.window.dark_diagonal = board.is_dark(column, row);
    corner.window.blur_px = how.blur_px;
    corner.window.marker_share = marker_share(board);
    corner.window.dark_cells = how.markers.at(column, row, corner.window.dark_diagonal);
    if (how.bent) corner.window.board = how.bent->near(b);
    corner.window.coarse = how.coarse;
    corner.fit = fit_saddle(grey, corner.window);
    missed += corner.fit.status == SaddleStatus::kFitted ? 0 : 1;
    if (missed > how.may_miss) break;
  }
  return corners;
}

/// What the corners of one picture have in common.
struct Fellows {
  double residual, contrast, blur_px;
  double most_residual;
  bool marked;

  Fellows(const Board& board, const std::vector<MeasuredCorner>& corners, const CheckerboardOptions& options)
      // Below one grey level the residual is the rounding of the grey values, not a fault.
      : residual(std::max(1.0, median_of(corners, [](const SaddleFit& f) { return f.residual_rms; }))),
        contrast(median_of(corners, [](const SaddleFit& f) { return f.contrast; })),
        blur_px(median_of(corners, blur_of)),
        most_residual(options.max_fit_residual_ratio * residual),
        marked(has_markers(board)) {}

  // Glare, a hidden corner, a neighbour's edge stand out.
  bool accept(const SaddleFit& fit, const Vector2d& expected, const Matrix2d& square) const {
    if (fit.status != SaddleStatus::kFitted || !is_saddle(fit)) return false;
    return fit.residual_rms <= most_residual && fit.contrast >= kMinContrastRatio * contrast &&
           blur_of(fit) <= kMaxBlurRatio * blur_px &&
           (fit.pixel - expected).norm() <= kMaxHomographyShare * square_height(square);
  }
  // Not the end of a board. Markers tell where theirs ends, and leave residuals of their own.
  bool is_saddle(const SaddleFit& fit) const {
    return marked || fit.residual_rms <= std::hypot(kMostModelError * fit.contrast, kMostOfOthers * residual);
  }
};

void drop_outliers(const Board& board, const Homography& H, const CheckerboardOptions& options,
                   std::vector<MeasuredCorner>* corners) {
  const Fellows fellows(board, *corners, options);
  for (MeasuredCorner& corner : *corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    Vector2d expected = Vector2d::Constant(1e9);
    H.map(place_of_corner(board, corner.id), &expected);
    if (!fellows.accept(corner.fit, expected, corner.window.square)) corner.fit.status = SaddleStatus::kNoSaddle;
  }
}

int count(const std::vector<MeasuredCorner>& corners, SaddleStatus status) {
  return static_cast<int>(std::count_if(corners.begin(), corners.end(),
                                        [status](const MeasuredCorner& c) { return c.fit.status == status; }));
}

// Every outer row and column needs two corners, else the board could lie one square further.
bool outline_is_fixed(const Board& board, const std::vector<MeasuredCorner>& corners) {
  std::array<int, 4> sides{};
  for (const MeasuredCorner& corner : corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    const int x = corner.id % board.inner_corners_x(), y = corner.id / board.inner_corners_x();
    sides[0] += x == 0;
    sides[1] += x == board.inner_corners_x() - 1;
    sides[2] += y == 0;
    sides[3] += y == board.inner_corners_y() - 1;
  }
  return *std::min_element(sides.begin(), sides.end()) >= 2;
}

// Part of the places beyond one side of the board at which squares meet as within it: one after the other along the
// side, each a corner if the pattern went on.
double goes_on(const Image8& grey, const Board& board, const Homography& H, const Fellows& fellows,
               const std::vector<Vector2d>& places) {
  int looked = 0, met = 0;
  for (const Vector2d& place : places) {
    SaddleWindow window;
    if (!H.map(place, &window.centre) || !square_at(H, place, window.centre, 1.0, &window.square)) continue;
    window.dark_diagonal = board.is_dark(static_cast<int>(place.x()), static_cast<int>(place.y()));
    window.blur_px = std::clamp(fellows.blur_px, 0.4, 6.0);
    window.coarse = true;
    const SaddleFit fit = fit_saddle(grey, window);
    looked += fit.status != SaddleStatus::kOutsideImage;
    // Without noise to speak of: pictures of few rays a pixel hide the end of a board from a residual.
    const bool as_others = fit.residual_rms <= std::min(2.0 * fellows.residual, kMostModelError * fit.contrast);
    met += as_others && fellows.accept(fit, window.centre, window.square);
  }
  return met >= 2 ? static_cast<double>(met) / looked : 0.0;
}

// Squares that go on beyond the board are a floor's, a cloth's or another board's.
bool lies_in_a_larger_pattern(const Image8& grey, const Board& board, const Homography& H, const Fellows& fellows) {
  constexpr double kHalf = 0.5;
  const int nx = board.inner_corners_x(), ny = board.inner_corners_y();
  std::array<std::vector<Vector2d>, 4> sides;
  for (int x = 0; x < nx; ++x) {
    sides[0].emplace_back(x, -1);
    sides[1].emplace_back(x, ny);
  }
  for (int y = 0; y < ny; ++y) {
    sides[2].emplace_back(-1, y);
    sides[3].emplace_back(nx, y);
  }
  return std::any_of(sides.begin(), sides.end(),
                     [&](const auto& places) { return goes_on(grey, board, H, fellows, places) >= kHalf; });
}

double smallest_square(const std::vector<MeasuredCorner>& corners) {
  double smallest = 1e9;
  for (const MeasuredCorner& corner : corners) smallest = std::min(smallest, square_height(corner.window.square));
  return smallest;
}

// The squares' outer corners lie in the image, so that what is missing is hidden and not beyond the image's edge.
bool outline_in_image(const Board& board, const Homography& H, const Image8& grey) {
  for (const int x : {-1, board.inner_corners_x()}) {
    for (const int y : {-1, board.inner_corners_y()}) {
      Vector2d p;
      if (!H.map(Vector2d(x, y), &p) || p.minCoeff() < -0.5 || p.x() > grey.width - 0.5 || p.y() > grey.height - 0.5)
        return false;
    }
  }
  return true;
}

std::optional<double> grey_at(const Image8& grey, const Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= grey.width || y >= grey.height) return std::nullopt;
  return grey.at(x, y);
}

// Light less dark over light and dark (Michelson's contrast), by the middles of all squares.
double print_contrast(const Image8& grey, const Homography& H, const Board& board) {
  double difference = 0.0, sum = 0.0;
  for (int x = -1; x < board.inner_corners_x(); ++x) {
    for (int y = -1; y < board.inner_corners_y(); ++y) {
      Vector2d middle;
      if (!H.map(Vector2d(x + 0.5, y + 0.5), &middle)) continue;
      const double value = grey_at(grey, middle).value_or(0.0);
      difference += board.is_dark(x, y) ? -value : value;
      sum += value;
    }
  }
  return sum > 0.0 ? difference / sum : 0.0;
}

// Where a colour filter shows, corners are measured again without its effect: it moves edges that run along the pixels'
// rows and columns by hundredths of a pixel, all along them alike.
void unfilter(const Image8& grey, std::vector<MeasuredCorner>* corners) {
  FilterEquations equations;
  for (const MeasuredCorner& corner : *corners)
    if (corner.fit.status == SaddleStatus::kFitted) equations += filter_equations(grey, corner.window, corner.fit);
  const std::optional<ColourFilter> filter = solve_filter(equations);
  if (!filter) return;
  for (MeasuredCorner& corner : *corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    SaddleWindow window = corner.window;
    window.filter = &*filter;
    const SaddleFit again = fit_saddle(grey, window);
    if (again.status == SaddleStatus::kFitted) corner.fit = again;
  }
}

// A picture whose edges are sharper than a pixel's own area leaves them was made of few rays a pixel: every edge is
// known to their distance alone, and where it runs along the pixels' rows the error is the same all along it, so that
// no residual shows it. The distance is told by the residuals of the whole board.
struct Aliasing {
  double ray_distance_px = 0.0;  ///< 0: none
};

Aliasing aliasing_of(const std::vector<MeasuredCorner>& corners) {
  // With one ray a pixel the model's residual is a third of the contrast.
  constexpr double kPixelsPerResidual = 3.2;
  // A pixel's own area blurs by sqrt(1/12); a fit finds no less than 0.3 px.
  constexpr double kAliasedBlur = 0.35;
  if (median_of(corners, blur_of) > kAliasedBlur) return {};
  const double of_residual =
      kPixelsPerResidual * median_of(corners, [](const SaddleFit& f) { return f.residual_rms / f.contrast; });
  // Where all edges run along the rows no residual is left.
  return {std::clamp(of_residual, 0.25, 1.0)};
}

// Covariance of the corner by what rays leave of its two edges: over the window an edge that leans across them meets
// them at other phases again and again.
Matrix2d covariance_of(const Aliasing& aliasing, const MeasuredCorner& corner) {
  constexpr double kReachPx = 12.0;
  constexpr double kPhases = 4.0;  // how fast the phases that an edge meets average out
  if (aliasing.ray_distance_px <= 0.0) return Matrix2d::Zero();
  Matrix2d across;
  Vector2d variance;
  for (int edge = 0; edge < 2; ++edge) {
    const double c = std::cos(corner.fit.edge_rad[edge]), s = std::sin(corner.fit.edge_rad[edge]);
    const double length = 2.0 * std::min(kReachPx, corner.window.square.col(edge).norm());
    const double slope = std::min(std::abs(c), std::abs(s)) / std::max(std::abs(c), std::abs(s));
    const double phases = length * slope / aliasing.ray_distance_px;
    variance[edge] = aliasing.ray_distance_px * aliasing.ray_distance_px / 12.0 / (1.0 + kPhases * phases * phases);
    across.row(edge) << -s, c;
  }
  const Matrix2d edges_to_corner = across.inverse();
  return edges_to_corner * variance.asDiagonal() * edges_to_corner.transpose();
}

// Variance along each axis by the bits of a ChArUco board's markers: where squares are small their light reaches the
// corners' edges through the dark border, by blur, and the model does not follow all of it.
double variance_by_bits(const Board& board, const MeasuredCorner& corner) {
  constexpr double kReachPx = 0.08;  // measured on squares of 5 to 8 px
  if (board.type != "charuco") return 0.0;
  const double share = marker_share(board), cells = dictionary_of(board).bits + 2.0;
  const double distance_px = square_height(corner.window.square) * (0.5 * (1.0 - share) + share / cells);
  const double blurs = distance_px / blur_of(corner.fit);
  return kReachPx * kReachPx * std::exp(-blurs * blurs);
}

// Corners that tell a pose: some in each direction.
bool tells_a_pose(const Board& board, const std::vector<MeasuredCorner>& corners) {
  constexpr std::size_t kLeast = 6;
  std::set<int> columns, rows, ids;
  for (const MeasuredCorner& corner : corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    ids.insert(corner.id);
    columns.insert(corner.id % board.inner_corners_x());
    rows.insert(corner.id / board.inner_corners_x());
  }
  return ids.size() >= kLeast && columns.size() >= 2 && rows.size() >= 2;
}

std::vector<std::pair<int, Vector2d>> places_of(const std::vector<MeasuredCorner>& corners) {
  std::vector<std::pair<int, Vector2d>> places;
  for (const MeasuredCorner& corner : corners)
    if (corner.fit.status == SaddleStatus::kFitted) places.emplace_back(corner.id, corner.fit.pixel);
  return places;
}

// How far corners lie off a plane's picture that is bent as lenses and bows bend it, beyond what they are known to: a
// tenth of a square of what only looks like squares. 0 where there are too few corners to tell.
double disorder(const Board& board, const std::vector<MeasuredCorner>& corners) {
  constexpr double kSigmas = 2.0;
  const std::vector<PlanePoint> points = points_of(board, corners);
  const std::optional<BentPlane> bent = BentPlane::fit(points);
  if (!bent) return 0.0;
  double squares = 0.0;
  for (const auto& [place, pixel] : points) {
    Vector2d expected = pixel;
    bent->map(place, &expected);
    squares += (pixel - expected).squaredNorm();
  }
  const double rms = std::sqrt(squares / (2.0 * static_cast<double>(points.size()) - BentPlane::kUnknowns));
  const double sigma = std::sqrt(median_of(corners, [](const SaddleFit& f) { return 0.5 * f.covariance_px2.trace(); }));
  return rms > kSigmas * sigma ? rms / smallest_square(corners) : 0.0;
}

// From the fitted corner before one to the one behind it, along an axis; zero where the corner has no neighbour.
Vector2d line_through(const Board& board, const std::vector<MeasuredCorner>& corners, const MeasuredCorner& corner,
                      int axis) {
  const int columns = board.inner_corners_x(), step = axis == 0 ? 1 : columns;
  const int place = axis == 0 ? corner.id % columns : corner.id / columns;
  const int last = (axis == 0 ? columns : board.inner_corners_y()) - 1;
  const auto neighbour = [&](bool exists, int id) {
    const bool fitted = exists && corners[static_cast<std::size_t>(id)].fit.status == SaddleStatus::kFitted;
    return fitted ? corners[static_cast<std::size_t>(id)].fit.pixel : corner.fit.pixel;
  };
  return neighbour(place < last, corner.id + step) - neighbour(place > 0, corner.id - step);
}

// How far edges run off the lines through the neighbouring corners, rms [rad]: of what only looks like squares, every
// corner has edges of its own.
double crookedness(const Board& board, const std::vector<MeasuredCorner>& corners) {
  double sum = 0.0;
  int edges = 0;
  for (const MeasuredCorner& corner : corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d line = line_through(board, corners, corner, axis);
      if (line.isZero(0.0)) continue;
      const double angle = corner.fit.edge_rad[axis];
      sum += std::pow(line.x() * std::sin(angle) - line.y() * std::cos(angle), 2) / line.squaredNorm();
      ++edges;
    }
  }
  return edges > 0 ? std::sqrt(sum / edges) : 0.0;
}

// Edges that run off the corners' lines, and a model that does not fit them: a picture that motion blurs has the former
// alone.
bool is_crooked(const Board& board, const std::vector<MeasuredCorner>& corners) {
  return crookedness(board, corners) > kMaxCrookedness_rad &&
         median_of(corners, [](const SaddleFit& f) { return f.residual_rms / f.contrast; }) > kMostModelError;
}

// Why a measured board cannot be used; absent if it can. Markers tell which corners are seen, so some are enough.
std::optional<Finding> fault_of(const Board& board, const std::vector<MeasuredCorner>& corners,
                                const CheckerboardOptions& options) {
  const int fitted = count(corners, SaddleStatus::kFitted);
  const double smallest = smallest_square(corners), blur = median_of(corners, blur_of);
  if (smallest < (board.has_tags() ? kMinBorderPx : kMinSquarePx))
    return Finding("board.too_small", {{"square_px", smallest}});
  if (fitted > 0 && blur > kMaxBlurShare * smallest) return Finding("board.blurred", {{"edge_px", 2.0 * blur}});
  if (has_markers(board)) {
    if (tells_a_pose(board, corners)) return std::nullopt;
    // Windows beside markers that leave too few pixels are no sign of something in front of them.
    if (board.type == "charuco" && 2 * count(corners, SaddleStatus::kTooSmall) > board.corner_count())
      return Finding("board.markers_too_small", {{"cell_px", marker_cell_px(board, smallest)}});
    return Finding("board.partly_hidden", {{"corners", fitted}, {"of", board.corner_count()}});
  }
  if (count(corners, SaddleStatus::kOutsideImage) > 0 && fitted < board.corner_count()) return Finding("board.cut_off");
  if (fitted < options.min_corner_share * board.corner_count() || !outline_is_fixed(board, corners))
    return Finding("board.partly_hidden", {{"corners", fitted}, {"of", board.corner_count()}});
  return std::nullopt;
}

struct CoarseCorners {
  std::vector<MeasuredCorner> corners;
  std::optional<Homography> H;  ///< of those that were found
};

// All corners from their seeds and where these expect the others. From a few seeds alone the farther ones are expected
// too far off: a board of which markers tell a part is measured again from what was found, as long as more is.
CoarseCorners measure_coarsely(const Image8& grey, const Board& board, Homography H,
                               std::vector<std::pair<int, Vector2d>> seeds, const std::optional<TagSides>& tags,
                               const MarkerCells& markers, const CheckerboardOptions& options) {
  constexpr double kFirstBlur = 0.9;
  constexpr int kMaxRounds = 4;
  const int all = board.corner_count();
  // How many corners a whole grid misses is told to people, and markers need six alone.
  const bool part = !has_markers(board) && static_cast<int>(seeds.size()) < all;
  const int may_miss = part ? all - static_cast<int>(std::ceil(kHopeless * all)) : all;
  for (int round = 0;; ++round) {
    CoarseCorners coarse = {measure(grey, board, H, seeds, {tags, markers, {}, kFirstBlur, true, may_miss}), {}};
    coarse.H = homography_of(board, coarse.corners);
    if (!coarse.H) return coarse;
    drop_outliers(board, *coarse.H, options, &coarse.corners);
    if (!has_markers(board)) return coarse;
    std::vector<std::pair<int, Vector2d>> found = places_of(coarse.corners);
    coarse.H = homography_of(board, coarse.corners);
    if (!coarse.H || found.size() <= seeds.size() || round + 1 == kMaxRounds) return coarse;
    H = *coarse.H;
    seeds = std::move(found);
  }
}

}  // namespace

Vector2d place_of_corner(const Board& board, int id) {
  if (board.has_tags()) return board.corner(id).head<2>() / (0.5 * board.square_m);
  return Vector2d(id % board.inner_corners_x(), id / board.inner_corners_x());
}

double marker_cell_px(const Board& board, double square_px) {
  return square_px * marker_share(board) / (dictionary_of(board).bits + 2.0);
}

BoardFit fit_board(const Image8& grey, const Board& board, const BoardPlacement& placement,
                   const CheckerboardOptions& options) {
  BoardFit result;
  std::vector<PlanePoint> points;
  for (const auto& [id, pixel] : placement.seeds) points.push_back({place_of_corner(board, id), pixel});
  std::optional<Homography> H = Homography::fit(points);
  result.why_not = Finding("board.not_found");
  if (!H) return result;
  std::optional<TagSides> tags;
  if (board.has_tags()) tags.emplace(board, placement.tag_border_bits);
  const MarkerCells markers(board);
  auto [corners, found] = measure_coarsely(grey, board, *H, placement.seeds, tags, markers, options);
  H = std::move(found);
  result.fitted = count(corners, SaddleStatus::kFitted);
  if (!has_markers(board) && result.fitted < kHopeless * board.corner_count()) {
    const bool whole = static_cast<int>(placement.seeds.size()) == board.corner_count();
    const double smallest = whole ? smallest_square(corners) : kMinSquarePx;
    result.why_not = smallest < kMinSquarePx
                         ? Finding("board.too_small", {{"square_px", smallest}})
                         : Finding("board.partly_hidden", {{"corners", result.fitted}, {"of", board.corner_count()}});
    return result;
  }
  if (H) {
    const std::optional<BentPlane> bent = BentPlane::fit(points_of(board, corners));
    corners =
        measure(grey, board, *H, places_of(corners),
                {tags, markers, bent, std::clamp(median_of(corners, blur_of), 0.4, 6.0), false, board.corner_count()});
    drop_outliers(board, *H, options, &corners);
  }
  result.outside = count(corners, SaddleStatus::kOutsideImage);
  result.fitted = count(corners, SaddleStatus::kFitted);
  result.why_not = fault_of(board, corners, options);
  const bool incomplete = !has_markers(board) && count(corners, SaddleStatus::kFitted) < board.corner_count();
  if (!result.why_not && incomplete && (!H || !outline_in_image(board, *H, grey)))
    result.why_not = Finding("board.cut_off");
  if (!result.why_not && H && !has_markers(board) &&
      (print_contrast(grey, *H, board) < kMinPrintContrast || disorder(board, corners) > kMaxDisorder ||
       is_crooked(board, corners)))
    result.why_not = Finding("board.not_found");
  if (!result.why_not && H && !has_markers(board) &&
      lies_in_a_larger_pattern(grey, board, *H, {board, corners, options})) {
    const auto [shorter, longer] = std::minmax({board.inner_corners_x(), board.inner_corners_y()});
    result.why_not = Finding("board.goes_on", {{"long", longer}, {"short", shorter}});
  }
  if (result.why_not) return result;
  unfilter(grey, &corners);
  const Aliasing aliasing = aliasing_of(corners);
  for (const MeasuredCorner& corner : corners) {
    if (corner.fit.status != SaddleStatus::kFitted) continue;
    const double least = options.min_sigma_px * options.min_sigma_px + variance_by_bits(board, corner);
    const Matrix2d floor = Matrix2d::Identity() * least;
    result.corners.push_back(
        {corner.id, corner.fit.pixel, corner.fit.covariance_px2 + floor + covariance_of(aliasing, corner)});
  }
  return result;
}

}  // namespace rigproof::detection
