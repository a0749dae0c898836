// How bright the pixels around the meeting of four squares are, and how that depends on where and how they meet.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "rigproof/core/conventions.h"

namespace rigproof::detection::saddle {

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
  double marker = 0.0;      ///< share of its light that markers take, twice, with the sign of light squares
  int column = 0, row = 0;  ///< in the image
};

struct Edge {
  Eigen::Vector2d along, across;
  explicit Edge(double angle) : along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x()) {}
};

inline double correlation_of(const Edge& first, const Edge& second) {
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
    const Eigen::Vector2d r(pixel.x - p_[kX], pixel.y - p_[kY]);
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
    const Eigen::Vector2d toward1 = first_.across - bend1 * first_.along,
                          toward2 = second_.across - bend2 * second_.along;
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

}  // namespace rigproof::detection::saddle
