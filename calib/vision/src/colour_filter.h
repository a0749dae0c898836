// What the colour filter over a camera's pixels leaves of a picture's edges.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace rigproof::detection {

/// Shares of a pixel's light that come from the pixels beside it (first four) and above and below it (last four), by
/// its place in Bayer's pattern, (x & 1) + 2 (y & 1), less their mean over the places, which is part of the edges'
/// blur: each pixel sees one of three colours, and the others are guessed from its neighbours.
using ColourFilter = Eigen::Matrix<double, 8, 1>;

/// Normal equations of the filter, from what fits without one left.
struct FilterEquations {
  Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
  ColourFilter gradient = ColourFilter::Zero();
  double residual_squares = 0.0;
  int pixels = 0;

  FilterEquations& operator+=(const FilterEquations& other);
};

/// The filter of a picture by all its corners together; absent where none shows, as in grey pictures.
std::optional<ColourFilter> solve_filter(const FilterEquations& of_all_corners);

}  // namespace rigproof::detection
