#include "saddle_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "rigproof/core/conventions.h"

namespace rigproof::detection {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

enum Parameter {
  kX,
  kY,
  kAngle1,
  kAngle2,
  kBlur1,
  kBlur2,
  kMean,
  kContrast,
  kSlopeX,
  kSlopeY,
  kCurve1,
  kCurve2,
  kCount
};
using Parameters = Eigen::Matrix<double, kCount, 1>;
using Normal = Eigen::Matrix<double, kCount, kCount>;

// Farthest pixel used: farther ones tell little more, and lens distortion bends the edges [px].
constexpr double kMaxReach = 12.0;
// A pixel farther than this many blurs from both edges tells only m and c.
constexpr double kEdgeReach = 4.0;
// Prior of an edge's curvature [1/px]: strong barrel distortion (k1 = -0.3) at fx 640 gives 4e-4.
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

/// erf(s / sqrt 2) and the density exp(-s^2/2) / sqrt(2 pi), from a table with cubic interpolation: error 1e-9.
class NormalTable {
 public:
  static const NormalTable& instance() {
    static const NormalTable table;
    return table;
  }
  double step(double s) const { return step(Place(s)); }
  // Both at once; the density is 0 beyond the table's end.
  void look_up(double s, double* step_at, double* density_at) const {
    const Place at(s);
    *step_at = step(at);
    *density_at = std::abs(s) > kLimit ? 0.0 : density(at);
  }

 private:
  static constexpr double kLimit = 6.0, kPerUnit = 64.0, kHalf = kLimit * kPerUnit;
  static constexpr std::size_t kSize = 2 * 384 + 1;

  // Where an argument lies in the tables.
  struct Place {
    std::size_t index;
    double t;  ///< from that entry to the next one
    explicit Place(double s) {
      const double x = std::clamp(s, -kLimit, kLimit) * kPerUnit + kHalf;
      index = std::min(static_cast<std::size_t>(x), kSize - 2);
      t = x - static_cast<double>(index);
    }
    // Hermite's cubic, from values and slopes at both ends.
    double between(double value0, double slope0, double value1, double slope1) const {
      const double rest = 1.0 - t;
      return rest * rest * (value0 * (1.0 + 2.0 * t) + slope0 * (t / kPerUnit)) +
             t * t * (value1 * (3.0 - 2.0 * t) - slope1 * (rest / kPerUnit));
    }
  };

  double step(const Place& at) const {
    const Entry &low = entries_[at.index], &high = entries_[at.index + 1];
    return at.between(low.step, 2.0 * low.density, high.step, 2.0 * high.density);
  }
  double density(const Place& at) const {
    const Entry &low = entries_[at.index], &high = entries_[at.index + 1];
    return at.between(low.density, low.slope, high.density, high.slope);
  }

  NormalTable() {
    constexpr double kInverseRoot = 0.39894228040143268;
    for (std::size_t i = 0; i < kSize; ++i) {
      const double s = (static_cast<double>(i) - kHalf) / kPerUnit;
      const double density = std::exp(-0.5 * s * s) * kInverseRoot;
      entries_[i] = {std::erf(s / std::sqrt(2.0)), density, -s * density};
    }
  }
  struct Entry {
    double step, density, slope;  ///< the slope is the density's
  };
  std::array<Entry, kSize> entries_;
};

/// Mean of sign(s1 + e1) sign(s2 + e2) under unit normals with correlation rho, and its derivatives by s1 and s2.
struct BlurredSign {
  double value, by_s1, by_s2;
};

/// Signs of normals with one correlation.
class CorrelatedSigns {
 public:
  explicit CorrelatedSigns(double rho) : rho_(rho), inverse_root_(1.0 / std::sqrt(1.0 - rho * rho)) {
    const Eigen::Array4d nodes(0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629);
    const Eigen::Array4d weights(0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693);
    correlation_ = rho * nodes;
    const Eigen::Array4d remainder = 1.0 - correlation_.square();
    exponent_ = -0.5 / remainder;
    weight_ = 4.0 * rho / (2.0 * kPi) * weights / remainder.sqrt();
  }

  BlurredSign at(double s1, double s2) const {
    BlurredSign result;
    double step1, step2, density1, density2;
    table_.look_up(s1, &step1, &density1);
    table_.look_up(s2, &step2, &density2);
    result.value = step1 * step2;
    const bool at_both = std::abs(s1) < 4.5 && std::abs(s2) < 4.5;
    if (at_both && std::abs(rho_) > 0.01) result.value += correlation_term(s1, s2);
    result.by_s1 = density1 > 0.0 ? 2.0 * density1 * table_.step((s2 - rho_ * s1) * inverse_root_) : 0.0;
    result.by_s2 = density2 > 0.0 ? 2.0 * density2 * table_.step((s1 - rho_ * s2) * inverse_root_) : 0.0;
    return result;
  }

 private:
  // 4 * integral of the bivariate normal density over the correlation from 0 to rho (Plackett 1954; Drezner and
  // Wesolowsky 1990), four Gauss-Legendre points: error below 1e-4 up to |rho| = 0.9.
  double correlation_term(double s1, double s2) const {
    const double squares = s1 * s1 + s2 * s2, twice_product = 2.0 * s1 * s2;
    return (weight_ * ((squares - correlation_ * twice_product) * exponent_).exp()).sum();
  }

  const NormalTable& table_ = NormalTable::instance();
  double rho_, inverse_root_;
  Eigen::Array4d correlation_, exponent_, weight_;
};

struct Pixel {
  double x, y;  ///< relative to the window's centre
  double grey;
  double marker = 0.0;  ///< share of its light that markers take, twice, with the sign of light squares
};

struct Edge {
  Vector2d along, across;
  explicit Edge(double angle) : along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x()) {}
};

double correlation_of(const Edge& first, const Edge& second) {
  return std::clamp(first.across.dot(second.across), -0.95, 0.95);
}

/// Brightness of a window's pixels under some parameters: what all of them share is worked out once.
class SaddleModel {
 public:
  explicit SaddleModel(const Parameters& p)
      : p_(p),
        first_(p[kAngle1]),
        second_(p[kAngle2]),
        signs_(correlation_of(first_, second_)),
        sharpness1_(1.0 / p[kBlur1]),
        sharpness2_(1.0 / p[kBlur2]) {}

  /// Brightness of a pixel and its derivative.
  template <typename Column>
  double at(const Pixel& pixel, Column&& d) const {
    const Vector2d r(pixel.x - p_[kX], pixel.y - p_[kY]);
    const double t1 = first_.along.dot(r), t2 = second_.along.dot(r);
    const double u1 = first_.across.dot(r), u2 = second_.across.dot(r);
    const double bend1 = p_[kCurve1] * t1, bend2 = p_[kCurve2] * t2;
    const double s1 = (u1 - 0.5 * bend1 * t1) * sharpness1_, s2 = (u2 - 0.5 * bend2 * t2) * sharpness2_;
    const BlurredSign sign = signs_.at(s1, s2);
    const double light = 1.0 + p_[kSlopeX] * pixel.x + p_[kSlopeY] * pixel.y;
    const double seen = sign.value - pixel.marker;
    const double flat = p_[kMean] + p_[kContrast] * seen;
    const double w1 = light * p_[kContrast] * sign.by_s1 * sharpness1_;
    const double w2 = light * p_[kContrast] * sign.by_s2 * sharpness2_;
    const Vector2d toward1 = first_.across - bend1 * first_.along, toward2 = second_.across - bend2 * second_.along;
    d[kX] = -(w1 * toward1.x() + w2 * toward2.x());
    d[kY] = -(w1 * toward1.y() + w2 * toward2.y());
    d[kAngle1] = -w1 * t1 * (1.0 + p_[kCurve1] * u1);
    d[kAngle2] = -w2 * t2 * (1.0 + p_[kCurve2] * u2);
    d[kBlur1] = -w1 * s1;
    d[kBlur2] = -w2 * s2;
    d[kMean] = light;
    d[kContrast] = light * seen;
    d[kSlopeX] = flat * pixel.x;
    d[kSlopeY] = flat * pixel.y;
    d[kCurve1] = -0.5 * w1 * t1 * t1;
    d[kCurve2] = -0.5 * w2 * t2 * t2;
    return flat * light;
  }

 private:
  const Parameters& p_;
  Edge first_, second_;
  CorrelatedSigns signs_;
  double sharpness1_, sharpness2_;
};

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

System linearise(const std::vector<Pixel>& pixels, const Parameters& p, double noise_variance) {
  System system;
  const SaddleModel model(p);
  Derivatives derivatives;
  int filled = 0;
  for (const Pixel& pixel : pixels) {
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
  for (const Parameter curve : {kCurve1, kCurve2})
    add_prior(curve, p[curve], noise_variance / (kCurvatureSigma * kCurvatureSigma), &system);
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
    const Vector2d uv = shape_.board_from_pixel * offset;
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
        pixels.push_back({offset.x(), offset.y(), static_cast<double>(grey.at(x, y)), sign * markers.dark(offset)});
      else
        ++missing;
    }
  }
  // A corner at the image's edge keeps its fit while most of its window is there.
  if (missing > static_cast<int>(pixels.size()) / 3) return std::nullopt;
  return pixels;
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
Minimum minimise(const std::vector<Pixel>& pixels, const Parameters& start, double noise_variance, double reach,
                 double converged_step) {
  Minimum best{start, linearise(pixels, start, noise_variance), false};
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
    if (is_plausible(next, reach)) system = linearise(pixels, next, noise_variance);
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

}  // namespace

SaddleFit fit_saddle(const Image8& grey, const SaddleWindow& window) {
  SaddleFit fit;
  if (!window.centre.allFinite() || !window.square.allFinite() || window.centre.cwiseAbs().maxCoeff() > 1e6 ||
      std::abs(window.square.determinant()) < 1.0)
    return fit;
  const std::optional<std::vector<Pixel>> pixels = gather(grey, window, window.blur_px);
  if (!pixels) {
    fit.status = SaddleStatus::kOutsideImage;
    return fit;
  }
  if (pixels->size() < 2 * kCount) {
    fit.status = SaddleStatus::kTooSmall;
    return fit;
  }
  const double reach = 0.6 * std::min(window.square.col(0).norm(), window.square.col(1).norm());
  const std::vector<Pixel>& used = *pixels;
  Minimum minimum = minimise(used, first_guess(window, used), kFirstNoiseVariance, reach, kCoarseStep);
  const double noise_variance = noise_variance_of(minimum.system, used.size());
  if (minimum.converged && !window.coarse)
    minimum = minimise(used, minimum.parameters, noise_variance, reach, kConvergedStep);
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
  fit.pixels = static_cast<int>(pixels->size());
  fit.residual_rms = std::sqrt(minimum.system.residual_squares / static_cast<double>(pixels->size()));
  return fit;
}

}  // namespace rigproof::detection
