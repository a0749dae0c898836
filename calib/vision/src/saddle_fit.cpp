#include "saddle_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "saddle_model.h"

namespace rigproof::detection {
namespace {

using namespace saddle;
using Eigen::Matrix2d;
using Eigen::Vector2d;

// Farthest pixel used: farther ones tell little more, and lens distortion bends the edges [px].
constexpr double kMaxReach = 12.0;
// A pixel farther than this many blurs from both edges tells only m and c.
constexpr double kEdgeReach = 4.0;
// Prior of an edge's curvature, about that of the board's picture [1/px]: strong barrel distortion (k1 = -0.3) at fx
// 640 gives 4e-4, a fisheye several times as much.
constexpr double kCurvatureSigma = 4e-4;
// Prior of the brightness slope [1/px]: a tenth over ten pixels.
constexpr double kSlopeSigma = 0.01;
// A pixel of which markers cover more says little of the edges, and more of the marker's bits.
constexpr double kMaxMarkerCover = 0.2;
constexpr double kMinBlur = 0.3;  // a pixel alone has sqrt(1/12)
constexpr double kQuantisationVariance = 1.0 / 12.0;
constexpr double kFirstNoiseVariance = 4.0;
constexpr int kMaxIterations = 25;
// A tenth of what a corner can be measured to, and enough to centre the window [px].
constexpr double kConvergedStep = 3e-4, kCoarseStep = 0.03;

/// Squared error and its normal equations.
struct System {
  double cost = 0.0;  ///< priors included
  double residual_squares = 0.0;
  Normal normal = Normal::Zero();
  Parameters gradient = Parameters::Zero();
};

void add_prior(Parameter which, double value, double weight, System* system) {
  system->normal(which, which) += weight;
  system->gradient[which] += weight * value;
  system->cost += weight * value * value;
}

// Derivatives of so many pixels at once: the sums of a tile of the normal equations stay in registers.
constexpr int kBatch = 16;
using Derivatives = Eigen::Matrix<double, kCount, kBatch>;

// Adds the outer products of the first columns to the lower half of the matrix.
void add_outer_products(const Derivatives& derivatives, int columns, Normal* normal) {
  constexpr int kTile = 4;
  static_assert(kCount % kTile == 0);
  for (int i = 0; i < kCount; i += kTile) {
    for (int j = 0; j <= i; j += kTile) {
      Eigen::Matrix<double, kTile, kTile> sum = normal->block<kTile, kTile>(i, j);
      for (int k = 0; k < columns; ++k)
        sum.noalias() += derivatives.col(k).segment<kTile>(i) * derivatives.col(k).segment<kTile>(j).transpose();
      normal->block<kTile, kTile>(i, j) = sum;
    }
  }
}

/// Pixels of a window, and what is expected of their edges.
struct Evidence {
  std::vector<Pixel> pixels;
  Vector2d curvature;  ///< of those along x (first) and y
};

System linearise(const Evidence& evidence, const Parameters& p, double noise_variance) {
  System system;
  const SaddleModel model(p);
  Derivatives derivatives;
  int filled = 0;
  for (const Pixel& pixel : evidence.pixels) {
    auto derivative = derivatives.col(filled);
    const double error = model.at(pixel, derivative) - pixel.grey;
    system.residual_squares += error * error;
    system.gradient += error * derivative;
    if (++filled < kBatch) continue;
    add_outer_products(derivatives, filled, &system.normal);
    filled = 0;
  }
  add_outer_products(derivatives, filled, &system.normal);
  system.normal.triangularView<Eigen::StrictlyUpper>() = system.normal.transpose();
  system.cost = system.residual_squares;
  const Vector2d bent = p.segment<2>(kCurve1) - evidence.curvature;
  add_prior(kCurve1, bent[0], noise_variance / (kCurvatureSigma * kCurvatureSigma), &system);
  add_prior(kCurve2, bent[1], noise_variance / (kCurvatureSigma * kCurvatureSigma), &system);
  for (const Parameter slope : {kSlopeX, kSlopeY})
    add_prior(slope, p[slope], noise_variance / (kSlopeSigma * kSlopeSigma), &system);
  return system;
}

/// The window in the board's own coordinates: it must not reach the edges of the neighbouring squares.
struct WindowShape {
  Matrix2d board_from_pixel;
  double limit_u = 0.0, limit_v = 0.0;  ///< in squares
  Vector2d across_u, across_v;          ///< unit normals of the edges along y and along x
  double height_u = 0.0, height_v = 0.0;
  Vector2d ahead, behind;  ///< how far edges are followed beyond these [squares]

  WindowShape(const SaddleWindow& window, double blur_px) : board_from_pixel(window.square.inverse()) {
    const double area = std::abs(window.square.determinant());
    height_u = area / window.square.col(1).norm();
    height_v = area / window.square.col(0).norm();
    const double margin = 3.0 * blur_px + 0.3;
    limit_u = std::clamp(1.0 - margin / height_u, 0.55, 0.95);
    limit_v = std::clamp(1.0 - margin / height_v, 0.55, 0.95);
    const auto reach = [&](const Vector2d& clean) -> Vector2d {
      return (clean.array() > 1.0).select(clean - Vector2d(margin / height_u, margin / height_v), Vector2d::Zero());
    };
    ahead = reach(window.clean_ahead);
    behind = reach(window.clean_behind);
  }
  bool holds(const Vector2d& offset, double blur_px) const {
    const Vector2d uv = board_from_pixel * offset;
    const double u = std::abs(uv.x()), v = std::abs(uv.y());
    const double near = kEdgeReach * blur_px;
    const bool near_u = u * height_u < near, near_v = v * height_v < near;
    if (u > limit_u || v > limit_v)
      return (near_v && v <= limit_v && goes_on(uv, 0)) || (near_u && u <= limit_u && goes_on(uv, 1));
    return near_u || near_v;
  }
  bool goes_on(const Vector2d& uv, int axis) const { return uv[axis] < ahead[axis] && -uv[axis] < behind[axis]; }
};

/// The markers in the two light squares at a corner.
class MarkerShade {
 public:
  MarkerShade(const SaddleWindow& window, const WindowShape& shape, double blur_px)
      : shape_(shape),
        share_(window.marker_share),
        per_square_(shape.height_u / blur_px, shape.height_v / blur_px),
        side_(window.dark_diagonal ? -1.0 : 1.0),
        board_(window.board),
        dark_cells_(window.dark_cells) {}

  /// Share of a pixel's light that falls on the markers' area.
  double cover(const Vector2d& offset) const { return share_ > 0.0 ? sum(offset, {}) : 0.0; }
  /// Share of it that falls on their dark cells.
  double dark(const Vector2d& offset) const { return share_ > 0.0 ? sum(offset, dark_cells_) : 0.0; }

 private:
  using Cells = std::array<const Eigen::MatrixXd*, 2>;
  static constexpr int kMostCells = 12;  // along a side; OpenCV's markers have up to 9
  using Shares = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCells, 1>;  // on the stack: one a pixel

  // Of the square ahead along x and of the one behind, which lie on opposite sides of the edge along x.
  double sum(const Vector2d& offset, const Cells& cells) const {
    const Vector2d uv = board_ ? board_->place(offset) : Vector2d(shape_.board_from_pixel * offset);
    return of_square(uv - Vector2d(0.5, 0.5 * side_), cells[0]) + of_square(uv + Vector2d(0.5, 0.5 * side_), cells[1]);
  }
  // At a place from the square's middle.
  double of_square(const Vector2d& at, const Eigen::MatrixXd* cells) const {
    if (cells == nullptr) return shares(at, 0, 1)[0] * shares(at, 1, 1)[0];
    const Shares across = *cells * shares(at, 0, cells->cols());
    return shares(at, 1, cells->rows()).dot(across);
  }
  // What each cell in a row of them takes of the light along an axis.
  Shares shares(const Vector2d& at, int axis, Eigen::Index cells) const {
    const NormalTable& table = NormalTable::instance();
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCells + 1, 1> steps(cells + 1);
    for (Eigen::Index i = 0; i <= cells; ++i)
      steps[i] = table.step((at[axis] + share_ * (0.5 - static_cast<double>(i) / static_cast<double>(cells))) *
                            per_square_[axis]);
    return 0.5 * (steps.head(cells) - steps.tail(cells));
  }

  const WindowShape& shape_;
  double share_;
  Vector2d per_square_;  ///< blurs in a square
  double side_;
  const std::optional<LocalPlane>& board_;
  Cells dark_cells_;
};

bool inside(const Image8& grey, int x, int y) { return x >= 0 && y >= 0 && x < grey.width && y < grey.height; }

// Pixels of the window; absent if the image ends within it.
std::optional<std::vector<Pixel>> gather(const Image8& grey, const SaddleWindow& window, double blur_px) {
  const WindowShape shape(window, blur_px);
  const MarkerShade markers(window, shape, blur_px);
  const double sign = window.dark_diagonal ? 2.0 : -2.0;
  std::vector<Pixel> pixels;
  const int reach = static_cast<int>(kMaxReach) + 1;
  const int cx = static_cast<int>(std::lround(window.centre.x())),
            cy = static_cast<int>(std::lround(window.centre.y()));
  int missing = 0;
  for (int y = cy - reach; y <= cy + reach; ++y) {
    for (int x = cx - reach; x <= cx + reach; ++x) {
      const Vector2d offset = Vector2d(x, y) - window.centre;
      if (offset.squaredNorm() > kMaxReach * kMaxReach || !shape.holds(offset, blur_px)) continue;
      const double cover = markers.cover(offset);
      if (cover > kMaxMarkerCover) continue;
      if (inside(grey, x, y))
        pixels.push_back(
            {offset.x(), offset.y(), static_cast<double>(grey.at(x, y)), sign * markers.dark(offset), x, y});
      else
        ++missing;
    }
  }
  // A corner at the image's edge keeps its fit while most of its window is there.
  if (missing > static_cast<int>(pixels.size()) / 3) return std::nullopt;
  return pixels;
}

Vector2d curvature_in(const SaddleWindow& window) {
  return window.board ? window.board->curvature() : Vector2d(Vector2d::Zero());
}

Parameters first_guess(const SaddleWindow& window, const std::vector<Pixel>& pixels) {
  double low = 255.0, high = 0.0;
  for (const Pixel& pixel : pixels) {
    low = std::min(low, pixel.grey);
    high = std::max(high, pixel.grey);
  }
  Parameters p = Parameters::Zero();
  p[kAngle1] = std::atan2(window.square(1, 0), window.square(0, 0));
  p[kAngle2] = std::atan2(window.square(1, 1), window.square(0, 1));
  p[kBlur1] = p[kBlur2] = window.blur_px;
  p.segment<2>(kCurve1) = curvature_in(window);
  p[kMean] = 0.5 * (low + high);
  // The first edge's normal points to +y of the board, the second one's to -x: at +x +y the product is negative.
  p[kContrast] = 0.5 * (high - low) * (window.dark_diagonal ? 1.0 : -1.0);
  return p;
}

bool is_plausible(const Parameters& p, double reach) {
  return p.allFinite() && std::hypot(p[kX], p[kY]) < reach && p[kBlur1] > 0.05 && p[kBlur2] > 0.05 &&
         p[kBlur1] < 12.0 && p[kBlur2] < 12.0;
}

struct Minimum {
  Parameters parameters;
  System system;
  bool converged = false;
};

double noise_variance_of(const System& system, std::size_t pixels) {
  // Grey values carry at least the noise of their rounding.
  return std::max(system.residual_squares / static_cast<double>(pixels - kCount), kQuantisationVariance);
}

// A step that takes no blur below its least. A blur that is held there leaves the others their own best step: edges of
// a picture without blur would never converge.
Parameters bounded_step(Normal normal, Parameters gradient, const Parameters& from) {
  Parameters step = normal.ldlt().solve(-gradient);
  const double held = kMinBlur + 1e-9;
  const bool first = from[kBlur1] < held && step[kBlur1] < 0.0, second = from[kBlur2] < held && step[kBlur2] < 0.0;
  if (!first && !second) return step;
  for (const Parameter blur : {kBlur1, kBlur2}) {
    if (!(blur == kBlur1 ? first : second)) continue;
    normal.row(blur).setZero();
    normal.col(blur).setZero();
    normal(blur, blur) = 1.0;
    gradient[blur] = 0.0;
  }
  return normal.ldlt().solve(-gradient);
}

// Levenberg-Marquardt. The noise variance only weighs the priors against the pixels.
Minimum minimise(const Evidence& evidence, const Parameters& start, double noise_variance, double reach,
                 double converged_step) {
  Minimum best{start, linearise(evidence, start, noise_variance), false};
  double damping = 1e-4;
  for (int iteration = 0; iteration < kMaxIterations && damping < 1e6 && !best.converged; ++iteration) {
    Normal damped = best.system.normal;
    damped.diagonal() *= 1.0 + damping;
    const Parameters step = bounded_step(damped, best.system.gradient, best.parameters);
    Parameters next = best.parameters + step;
    next[kBlur1] = std::max(next[kBlur1], kMinBlur);
    next[kBlur2] = std::max(next[kBlur2], kMinBlur);
    const bool small = std::hypot(step[kX], step[kY]) < converged_step;
    System system;
    if (is_plausible(next, reach)) system = linearise(evidence, next, noise_variance);
    if (!is_plausible(next, reach) || !(system.cost <= best.system.cost)) {
      best.converged = small;  // no better within rounding
      damping *= 10.0;
      continue;
    }
    // Dark and light have changed places: that is no corner of this board, whatever comes of it.
    if (next[kContrast] * start[kContrast] < 0.0) break;
    best.parameters = next;
    best.system = system;
    best.converged = small;
    damping = std::max(damping * 0.1, 1e-9);
  }
  return best;
}

/// Brightness of a window's model, and by how much that beside a pixel differs from it.
class Neighbours {
 public:
  Neighbours(const std::vector<Pixel>& pixels, const Parameters& p)
      : pixels_(pixels), model_(p), column_(pixels.front().column - kMiddle), row_(pixels.front().row - kMiddle) {
    brightness_.reserve(pixels.size());
    at_.fill(kNone);
    for (const Pixel& pixel : pixels) {
      at_[index(pixel.column, pixel.row)] = static_cast<int>(brightness_.size());
      brightness_.push_back(brightness_of(pixel));
    }
  }
  /// Mean of both sides less the pixel itself, along x and along y.
  Vector2d beside(std::size_t i) const {
    const Pixel& pixel = pixels_[i];
    return {0.5 * (at(pixel, -1, 0) + at(pixel, 1, 0)) - brightness_[i],
            0.5 * (at(pixel, 0, -1) + at(pixel, 0, 1)) - brightness_[i]};
  }

 private:
  // The first pixel lies anywhere along the window's upper side.
  static constexpr int kMiddle = 2 * static_cast<int>(kMaxReach) + 4, kSide = 2 * kMiddle + 1, kNone = -1;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>((row - row_) * kSide + column - column_);
  }
  double brightness_of(const Pixel& pixel) const {
    Parameters unused;
    return model_.at(pixel, unused);
  }
  double at(const Pixel& pixel, int dx, int dy) const {
    const int known = at_[index(pixel.column + dx, pixel.row + dy)];
    if (known != kNone) return brightness_[static_cast<std::size_t>(known)];
    Pixel neighbour = pixel;
    neighbour.x += dx;
    neighbour.y += dy;
    return brightness_of(neighbour);
  }

  const std::vector<Pixel>& pixels_;
  SaddleModel model_;
  int column_, row_;  ///< of the table's first entry, in the image
  std::array<int, static_cast<std::size_t>(kSide) * kSide> at_{};
  std::vector<double> brightness_;
};

// Of a pixel's share from beside it; that from above and below comes four further on.
int place_of(const Pixel& pixel) { return (pixel.column & 1) + 2 * (pixel.row & 1); }

// The pixels as they were before a colour filter that a model tells the effect of.
std::vector<Pixel> unfiltered(std::vector<Pixel> pixels, const Parameters& model, const ColourFilter& filter) {
  const Neighbours neighbours(pixels, model);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int place = place_of(pixels[i]);
    pixels[i].grey -= neighbours.beside(i).dot(Vector2d(filter[place], filter[place + 4]));
  }
  return pixels;
}

// The filter changes by the model, and the model by the filter: the second round is within a thousandth of a pixel.
Minimum minimise_unfiltered(const Evidence& evidence, const ColourFilter& filter, Minimum minimum,
                            double noise_variance, double reach) {
  for (int round = 0; round < 2; ++round)
    minimum = minimise({unfiltered(evidence.pixels, minimum.parameters, filter), evidence.curvature},
                       minimum.parameters, noise_variance, reach, kConvergedStep);
  return minimum;
}

}  // namespace

SaddleFit fit_saddle(const Image8& grey, const SaddleWindow& window) {
  SaddleFit fit;
  if (!window.centre.allFinite() || !window.square.allFinite() || window.centre.cwiseAbs().maxCoeff() > 1e6 ||
      std::abs(window.square.determinant()) < 1.0)
    return fit;
  std::optional<std::vector<Pixel>> gathered = gather(grey, window, window.blur_px);
  if (!gathered) {
    fit.status = SaddleStatus::kOutsideImage;
    return fit;
  }
  if (gathered->size() < 2 * kCount) {
    fit.status = SaddleStatus::kTooSmall;
    return fit;
  }
  const double reach = 0.6 * std::min(window.square.col(0).norm(), window.square.col(1).norm());
  const Evidence used{std::move(*gathered), curvature_in(window)};
  Minimum minimum = minimise(used, first_guess(window, used.pixels), kFirstNoiseVariance, reach, kCoarseStep);
  // Before a filter's effect is taken off: what its model does not follow is about as large.
  const double noise_variance = noise_variance_of(minimum.system, used.pixels.size());
  if (minimum.converged && !window.coarse)
    minimum = window.filter == nullptr ? minimise(used, minimum.parameters, noise_variance, reach, kConvergedStep)
                                       : minimise_unfiltered(used, *window.filter, minimum, noise_variance, reach);
  const Parameters& p = minimum.parameters;
  const bool right_colours = (p[kContrast] > 0.0) == window.dark_diagonal;
  if (!minimum.converged || !right_colours) return fit;
  const Normal covariance = noise_variance * minimum.system.normal.ldlt().solve(Normal::Identity());
  fit.covariance_px2 = covariance.topLeftCorner<2, 2>();
  if (!fit.covariance_px2.allFinite() || !(fit.covariance_px2.determinant() > 0.0)) return fit;
  fit.status = SaddleStatus::kFitted;
  fit.pixel = window.centre + p.head<2>();
  fit.blur_px = p.segment<2>(kBlur1);
  fit.edge_rad = p.segment<2>(kAngle1);
  fit.contrast = std::abs(p[kContrast]);
  fit.unknowns = p;
  fit.pixels = static_cast<int>(used.pixels.size());
  fit.residual_rms = std::sqrt(minimum.system.residual_squares / static_cast<double>(used.pixels.size()));
  return fit;
}

FilterEquations filter_equations(const Image8& grey, const SaddleWindow& window, const SaddleFit& fit) {
  FilterEquations equations;
  const std::optional<std::vector<Pixel>> gathered = gather(grey, window, window.blur_px);
  if (!gathered || gathered->empty()) return equations;
  const std::vector<Pixel>& pixels = *gathered;
  const SaddleModel model(fit.unknowns);
  const Neighbours neighbours(pixels, fit.unknowns);
  Normal normal = Normal::Zero();
  Eigen::Matrix<double, kCount, 8> shared = Eigen::Matrix<double, kCount, 8>::Zero();
  Parameters derivative;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double error = model.at(pixels[i], derivative) - pixels[i].grey;
    const Vector2d beside = neighbours.beside(i);
    const int x = place_of(pixels[i]), y = x + 4;
    normal += derivative * derivative.transpose();
    shared.col(x) += beside.x() * derivative;
    shared.col(y) += beside.y() * derivative;
    equations.normal(x, x) += beside.x() * beside.x();
    equations.normal(x, y) += beside.x() * beside.y();
    equations.normal(y, y) += beside.y() * beside.y();
    equations.gradient[x] += beside.x() * error;
    equations.gradient[y] += beside.y() * error;
    equations.residual_squares += error * error;
  }
  equations.normal.triangularView<Eigen::StrictlyLower>() = equations.normal.transpose();
  equations.normal -= shared.transpose() * normal.ldlt().solve(shared);
  equations.pixels = static_cast<int>(pixels.size());
  return equations;
}

}  // namespace rigproof::detection
