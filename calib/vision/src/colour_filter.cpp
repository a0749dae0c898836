#include "colour_filter.h"

#include <Eigen/Cholesky>

namespace rigproof::detection {
namespace {

// Prior of how unlike the places are: a channel's weight in a grey value is .11 to .59.
constexpr double kShareSigma = 0.3;
// Chi-square of the six unknowns from where there is a filter: noise alone never gives that, a demosaiced board 1,000s.
constexpr double kLeastEvidence = 50.0;

// Differences between the four places with mean zero, for either axis.
Eigen::Matrix<double, 8, 6> differences() {
  Eigen::Matrix<double, 4, 3> of_axis;
  of_axis << -0.5, -0.5, 0.5,  //
      0.5, -0.5, -0.5,         //
      -0.5, 0.5, -0.5,         //
      0.5, 0.5, 0.5;
  Eigen::Matrix<double, 8, 6> basis = Eigen::Matrix<double, 8, 6>::Zero();
  basis.topLeftCorner<4, 3>() = of_axis;
  basis.bottomRightCorner<4, 3>() = of_axis;
  return basis;
}

}  // namespace

FilterEquations& FilterEquations::operator+=(const FilterEquations& other) {
  normal += other.normal;
  gradient += other.gradient;
  residual_squares += other.residual_squares;
  pixels += other.pixels;
  return *this;
}

std::optional<ColourFilter> solve_filter(const FilterEquations& of_all_corners) {
  if (of_all_corners.pixels == 0) return std::nullopt;
  const Eigen::Matrix<double, 8, 6> basis = differences();
  const double variance = of_all_corners.residual_squares / of_all_corners.pixels;
  Eigen::Matrix<double, 6, 6> normal = basis.transpose() * of_all_corners.normal * basis;
  normal.diagonal().array() += variance / (kShareSigma * kShareSigma);
  const ColourFilter filter = -basis * normal.ldlt().solve(basis.transpose() * of_all_corners.gradient);
  // Negated, so that what is no number is no evidence either.
  if (!(-of_all_corners.gradient.dot(filter) > kLeastEvidence * variance)) return std::nullopt;
  return filter;
}

}  // namespace rigproof::detection
