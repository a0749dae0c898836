#include "board_picture.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "marker_codes.h"
#include "rigproof/core/random.h"
#include "rigproof/core/rotation_between.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Integral over [0, s] of the square wave that is +1 on [0, 1), -1 on [1, 2), ...: a triangle wave.
double wave_integral(double s) {
  const double phase = s - 2.0 * std::floor(0.5 * s);
  return phase < 1.0 ? phase : 2.0 - phase;
}

// Mean of the square wave over an interval of the given width.
double mean_wave(double s, double width) {
  const double half = 0.5 * std::max(width, 1e-9);
  return (wave_integral(s + half) - wave_integral(s - half)) / (2.0 * half);
}

// Share of an interval that lies within [low, high].
double coverage(double s, double width, double low, double high) {
  const double half = 0.5 * std::max(width, 1e-9);
  return std::max(0.0, std::min(s + half, high) - std::max(s - half, low)) / (2.0 * half);
}

// Height of the bent sheet, to the board's z: edges of the border stay.
double sheet_z(const Board& board, const BoardPictureOptions& options, double x_m) {
  const double half = 0.5 * board.square_m * board.squares_x + options.border_m;
  const double across = (x_m - board.centre().x()) / half;
  return -options.bow_m * (1.0 - across * across);
}

/// The board's plane as seen along rays.
class BoardTexture {
 public:
  BoardTexture(const Board& board, const Rigid3& T_camera_board, const BoardPictureOptions& options)
      : board_(board), options_(options) {
    const Eigen::Matrix3d R = T_camera_board.rotation_matrix();
    R_board_camera_ = R.transpose();
    eye_ = -R_board_camera_ * T_camera_board.translation;
    to_board_.col(0) = R.col(0) * board.square_m;
    to_board_.col(1) = R.col(1) * board.square_m;
    to_board_.col(2) = T_camera_board.translation;
    to_board_ = to_board_.inverse().eval();
    for (const BoardMarker& marker : markers_of(board)) marker_at_[{marker.ix, marker.iy}] = marker.id;
    if (marker_at_.empty()) return;
    border_ = board.has_tags() ? options.tag_border_bits : 1;
    pictures_ = detection::marker_pictures(dictionary_of(board), static_cast<int>(marker_at_.size()), border_);
    cells_ = dictionary_of(board).bits + 2 * border_;
  }

  // Coordinates in squares from the outer corner of the first square; false behind the board's horizon.
  bool hit(const Vector2d& ray, Vector2d* squares) const {
    const Vector3d p = to_board_ * ray.homogeneous();
    if (!(p.z() > 0.0)) return false;
    *squares = p.hnormalized() + Vector2d::Ones();
    if (options_.bow_m != 0.0) bend(ray, squares);
    return true;
  }
  // Grey value and share of the sample that shows the board, over a footprint [squares].
  void shade(const Vector2d& s, const Vector2d& footprint, double* grey, double* share) const {
    const Vector2d width = options_.point_samples ? Vector2d::Zero() : footprint;
    if (board_.has_tags()) return shade_tags(s, width, grey, share);
    const double border = options_.border_m / board_.square_m;
    const double x = coverage(s.x(), width.x(), -border, board_.squares_x + border);
    const double y = coverage(s.y(), width.y(), -border, board_.squares_y + border);
    *share = x * y;
    if (*share <= 0.0) return;
    const double inner =
        coverage(s.x(), width.x(), 0.0, board_.squares_x) * coverage(s.y(), width.y(), 0.0, board_.squares_y);
    // Both waves start with the first square: where it is dark it is dark where they agree.
    const double first = board_.is_dark(0, 0) ? 1.0 : -1.0;
    const double product = first * mean_wave(s.x(), width.x()) * mean_wave(s.y(), width.y());
    const double squares = 0.5 * (options_.dark + options_.light) - 0.5 * (options_.light - options_.dark) * product;
    *grey = inner * squares + (1.0 - inner) * options_.light;
    if (!marker_at_.empty()) *grey -= marker_cover(s, width) * (options_.light - options_.dark);
    const bool hidden = s.x() >= options_.hidden_from_x && s.x() < options_.hidden_to_x;
    if (hidden) *grey = options_.background;
  }

 private:
  // An AprilGrid: its tags and the small squares between them.
  void shade_tags(const Vector2d& s, const Vector2d& width, double* grey, double* share) const {
    const double side = board_.marker_side_m() / cells_, unit = board_.square_m,
                 low = board_.along(-1) - options_.border_m;
    const Vector2d p = (s - Vector2d::Ones()) * unit, size = width * unit;
    const Vector2d high(board_.along(board_.inner_corners_x()) + options_.border_m,
                        board_.along(board_.inner_corners_y()) + options_.border_m);
    *share = coverage(p.x(), size.x(), low, high.x()) * coverage(p.y(), size.y(), low, high.y());
    if (*share <= 0.0) return;
    const Vector2d from = ((p - 0.5 * size) / unit).array().floor(), to = ((p + 0.5 * size) / unit).array().floor();
    double dark = gaps(p.x(), size.x(), board_.inner_corners_x()) * gaps(p.y(), size.y(), board_.inner_corners_y());
    for (int y = static_cast<int>(from.y()); y <= static_cast<int>(to.y()); ++y)
      for (int x = static_cast<int>(from.x()); x <= static_cast<int>(to.x()); ++x) {
        if (x < 0 || y < 0 || x >= board_.squares_x || y >= board_.squares_y) continue;
        const int id = (board_.squares_y - 1 - y) * board_.squares_x + x;
        dark += cells_cover(id, (p - unit * Vector2d(x, y)) / side, size / side);
      }
    *grey = options_.light - dark * (options_.light - options_.dark);
    if (s.x() >= options_.hidden_from_x && s.x() < options_.hidden_to_x) *grey = options_.background;
  }
  // Share of an interval that lies between tags.
  double gaps(double at_m, double width_m, int corners) const {
    double sum = 0.0;
    const int cell = static_cast<int>(std::floor(at_m / board_.square_m));
    for (int i = std::max(0, 2 * cell - 2); i <= std::min(corners, 2 * cell + 4); i += 2)
      sum += coverage(at_m, width_m, board_.along(i - 1), board_.along(i));
    return sum;
  }

  // Share of a footprint that is on dark cells of the marker in its square.
  double marker_cover(const Vector2d& s, const Vector2d& width) const {
    const Vector2d first = s.array().floor();
    const auto marker = marker_at_.find({static_cast<int>(first.x()), static_cast<int>(first.y())});
    if (marker == marker_at_.end()) return 0.0;
    const double side = board_.marker_side_m() / board_.square_m / cells_;
    const Vector2d at = ((s - first).array() - 0.5 * (1.0 - side * cells_)) / side;
    return cells_cover(marker->second, at, width / side);
  }

  // Share of a footprint at so many cells from a marker's first corner.
  double cells_cover(int id, const Vector2d& at, const Vector2d& size) const {
    const auto range = [this](double middle, double extent) {
      return std::pair(std::max(0, static_cast<int>(std::floor(middle - 0.5 * extent))),
                       std::min(cells_ - 1, static_cast<int>(std::floor(middle + 0.5 * extent))));
    };
    const auto [x0, x1] = range(at.x(), size.x());
    const auto [y0, y1] = range(at.y(), size.y());
    double dark = 0.0;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        if (pictures_[static_cast<std::size_t>(id)](y + 3 - border_, x + 3 - border_) == 0.0F)
          dark += coverage(at.x(), size.x(), x, x + 1.0) * coverage(at.y(), size.y(), y, y + 1.0);
    return dark;
  }

  // From where the ray meets the plane to where it meets the bent sheet: a bow is small, so each round gains two
  // digits.
  void bend(const Vector2d& ray, Vector2d* squares) const {
    const Vector3d direction = R_board_camera_ * ray.homogeneous();
    for (int round = 0; round < 5; ++round) {
      const double z = sheet_z(board_, options_, board_.square_m * (squares->x() - 1.0));
      const Vector3d p = eye_ + (z - eye_.z()) / direction.z() * direction;
      *squares = p.head<2>() / board_.square_m + Vector2d::Ones();
    }
  }

  Board board_;
  BoardPictureOptions options_;
  Eigen::Matrix3d to_board_;
  Eigen::Matrix3d R_board_camera_;
  std::map<std::pair<int, int>, int> marker_at_;  // ids by square
  std::vector<Eigen::MatrixXf> pictures_;
  int cells_ = 0, border_ = 1;
  Vector3d eye_;  // the camera in the board's frame
};

// A fine checker texture in one part, rectangles of all sizes elsewhere.
ImageF draw_background(int width, int height, const BoardPictureOptions& options) {
  ImageF image(width, height, 1, static_cast<float>(options.background));
  if (!options.clutter) return image;
  RandomStream random(options.seed, "clutter");
  for (int k = 0; k < 60; ++k) {
    const int w = 4 + static_cast<int>(random.below(static_cast<std::uint32_t>(width / 3)));
    const int h = 4 + static_cast<int>(random.below(static_cast<std::uint32_t>(height / 3)));
    const int x0 = static_cast<int>(random.below(static_cast<std::uint32_t>(width)));
    const int y0 = static_cast<int>(random.below(static_cast<std::uint32_t>(height)));
    const bool checker = k % 10 == 0;
    const auto grey = static_cast<float>(random.uniform(20.0, 235.0));
    const int tile = 5 + static_cast<int>(random.below(12));
    for (int y = y0; y < std::min(height, y0 + h); ++y)
      for (int x = x0; x < std::min(width, x0 + w); ++x)
        image.at(x, y) = checker && ((x / tile + y / tile) % 2 == 0) ? 255.0F - grey : grey;
  }
  for (float& value : image.pixels) value += static_cast<float>(random.normal(0.0, 6.0));
  return image;
}

std::vector<float> gaussian_kernel(double sigma) {
  const int radius = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<float> kernel;
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -radius; i <= radius; ++i)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum));
  return kernel;
}

// Blur and area sampling at once along x; called twice with a transposition between.
ImageF reduce_and_transpose(const ImageF& fine, int factor, const std::vector<float>& kernel) {
  // Combined kernel: the box of one pixel after the Gaussian.
  std::vector<float> both(kernel.size() + static_cast<std::size_t>(factor) - 1, 0.0F);
  for (std::size_t i = 0; i < kernel.size(); ++i)
    for (std::size_t j = 0; j < static_cast<std::size_t>(factor); ++j)
      both[i + j] += kernel[i] / static_cast<float>(factor);
  const int radius = static_cast<int>(kernel.size() / 2), width = fine.width / factor;
  ImageF result(fine.height, width);
  std::vector<float> padded(static_cast<std::size_t>(fine.width + 2 * radius));
  for (int y = 0; y < fine.height; ++y) {
    const float* row = fine.row(y);
    for (int x = -radius; x < fine.width + radius; ++x)
      padded[static_cast<std::size_t>(x + radius)] = row[std::clamp(x, 0, fine.width - 1)];
    for (int x = 0; x < width; ++x) {
      const float* source = padded.data() + static_cast<std::ptrdiff_t>(x) * factor;
      float sum = 0.0F;
      for (std::size_t k = 0; k < both.size(); ++k) sum += both[k] * source[k];
      result.at(y, x) = sum;
    }
  }
  return result;
}

// What the lens passes at a pixel over what it passes in the middle.
double passed_light(const Camera& camera, const BoardPictureOptions& options, int x, int y) {
  if (options.corner_light == 1.0) return 1.0;
  const double half_x = 0.5 * (camera.width_px - 1), half_y = 0.5 * (camera.height_px - 1);
  const double r2 = (Vector2d(x - half_x, y - half_y) / std::hypot(half_x, half_y)).squaredNorm();
  return std::pow(1.0 + (1.0 / std::sqrt(options.corner_light) - 1.0) * r2, -2.0);
}

struct Box {
  int x0, y0, x1, y1;  ///< pixels, end excluded
};

// Pixels that the board and its blur can touch.
Box board_box(const Camera& camera, const Board& board, const Rigid3& T_camera_board, double border_m) {
  Vector2d low(camera.width_px, camera.height_px), high(0.0, 0.0);
  for (int i = 0; i <= 16; ++i) {
    for (int side = 0; side < 4; ++side) {
      const double a = board.along(-1) - border_m, t = i / 16.0;
      const double bx = board.along(board.inner_corners_x()) + border_m;
      const double by = board.along(board.inner_corners_y()) + border_m;
      const double x = side == 0 ? a : side == 1 ? bx : a + t * (bx - a);
      const double y = side == 2 ? a : side == 3 ? by : a + t * (by - a);
      Vector2d pixel;
      if (!camera.project(T_camera_board * Vector3d(x, y, 0.0), &pixel))
        return {0, 0, camera.width_px, camera.height_px};
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
  }
  constexpr int kMargin = 8;
  return {std::clamp(static_cast<int>(low.x()) - kMargin, 0, camera.width_px),
          std::clamp(static_cast<int>(low.y()) - kMargin, 0, camera.height_px),
          std::clamp(static_cast<int>(high.x()) + kMargin, 0, camera.width_px),
          std::clamp(static_cast<int>(high.y()) + kMargin, 0, camera.height_px)};
}

/// Where the ray of each sample of a row meets the board [squares].
struct RowOfHits {
  std::vector<Vector2d> squares;
  std::vector<char> valid;

  RowOfHits(const Camera& camera, const BoardTexture& texture, const Box& box, int n, int y)
      : squares(static_cast<std::size_t>((box.x1 - box.x0) * n + 1)), valid(squares.size()) {
    const double step = 1.0 / n, v = box.y0 - 0.5 + (y + 0.5) * step;
    for (std::size_t x = 0; x < squares.size(); ++x) {
      Vector3d ray;
      const double u = box.x0 - 0.5 + (static_cast<double>(x) + 0.5) * step;
      valid[x] = camera.unproject({u, v}, &ray) && texture.hit(ray.head<2>(), &squares[x]);
    }
  }
};

ImageF draw_fine(const Camera& camera, const BoardTexture& texture, const ImageF& background, const Box& box, int n) {
  ImageF fine((box.x1 - box.x0) * n, (box.y1 - box.y0) * n);
  RowOfHits below(camera, texture, box, n, 0);
  for (int y = 0; y < fine.height; ++y) {
    const RowOfHits row = std::move(below);
    below = RowOfHits(camera, texture, box, n, y + 1);
    for (int x = 0; x < fine.width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      const float behind = background.at(box.x0 + x / n, box.y0 + y / n);
      fine.at(x, y) = behind;
      if (!row.valid[i] || !row.valid[i + 1] || !below.valid[i]) continue;
      const Vector2d across = row.squares[i + 1] - row.squares[i], down = below.squares[i] - row.squares[i];
      double grey = 0.0, share = 0.0;
      texture.shade(row.squares[i], (across.cwiseAbs2() + down.cwiseAbs2()).cwiseSqrt(), &grey, &share);
      if (share > 0.0) fine.at(x, y) = static_cast<float>(share * grey) + static_cast<float>(1.0 - share) * behind;
    }
  }
  return fine;
}

}  // namespace

Image8 draw_board(const Camera& camera, const Board& board, const Rigid3& T_camera_board,
                  const BoardPictureOptions& options) {
  ImageF image = draw_background(camera.width_px, camera.height_px, options);
  const Box box = board_box(camera, board, T_camera_board, options.border_m);
  if (box.x1 > box.x0 && box.y1 > box.y0) {
    const BoardTexture texture(board, T_camera_board, options);
    const ImageF fine = draw_fine(camera, texture, image, box, options.supersampling);
    const std::vector<float> kernel = gaussian_kernel(std::max(options.psf_sigma_px, 0.05) * options.supersampling);
    const ImageF reduced =
        reduce_and_transpose(reduce_and_transpose(fine, options.supersampling, kernel), options.supersampling, kernel);
    for (int y = 0; y < reduced.height; ++y) std::copy_n(reduced.row(y), reduced.width, image.row(box.y0 + y) + box.x0);
  }
  RandomStream random(options.seed, "pixel noise");
  Image8 result(camera.width_px, camera.height_px);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const double light =
          (1.0 + options.slope_per_px * (x - camera.cx_px + y - camera.cy_px)) * passed_light(camera, options, x, y);
      double value = image.at(x, y) * light;
      if (options.noise_sigma > 0.0) value += random.normal(0.0, options.noise_sigma);
      result.at(x, y) = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  }
  return result;
}

std::vector<Vector2d> true_corners(const Camera& camera, const Board& board, const Rigid3& T_camera_board,
                                   const BoardPictureOptions& options) {
  std::vector<Vector2d> corners;
  for (const Vector3d& p : board.corners()) {
    Vector2d pixel;
    const Vector3d bent(p.x(), p.y(), options.bow_m == 0.0 ? 0.0 : sheet_z(board, options, p.x()));
    if (!camera.project(T_camera_board * bent, &pixel)) return {};
    corners.push_back(pixel);
  }
  return corners;
}

Rigid3 board_in_view(const Camera& camera, const Board& board, double distance_m, double obliquity_rad, double axis_rad,
                     double roll_rad, const Vector2d& pixel) {
  Vector3d ray = Vector3d::UnitZ();
  camera.unproject(pixel, &ray);
  const Vector3d axis(std::cos(axis_rad), std::sin(axis_rad), 0.0);
  // Facing the camera means facing along the ray, not along the optical axis.
  const Eigen::Quaterniond facing = rotation_between(Vector3d::UnitZ(), ray);
  const Eigen::Quaterniond rotation =
      facing * Eigen::Quaterniond(Eigen::AngleAxisd(obliquity_rad, axis)) * rotation_z(roll_rad);
  return {rotation, distance_m * ray.normalized() - rotation * board.centre()};
}

}  // namespace rigproof
