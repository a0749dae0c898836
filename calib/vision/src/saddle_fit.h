// A parametric model of the meeting of four squares, fitted to the grey values around it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "bent_plane.h"
#include "colour_filter.h"
#include "rigproof/core/image.h"

namespace rigproof::detection {

/// Where and how to look.
struct SaddleWindow {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< expected corner [px]
  /// Derivative of the pixel by the board coordinates at the corner: columns are one square along x and along y,
  /// the shorter of the two neighbours [px].
  Eigen::Matrix2d square = Eigen::Matrix2d::Identity();
  bool dark_diagonal = true;  ///< the squares at +x +y and -x -y of the corner are dark
  double blur_px = 0.8;       ///< first guess of the edges' blur
  bool coarse = false;        ///< stop at a few hundredths of a pixel
  /// Side of the markers in the middle of the light squares, over the squares'; 0: none. Pixels on them are left out,
  /// and what their blur leaves of the others' light is part of the model.
  double marker_share = 0.0;
  /// Dark (1) and light (0) cells of the markers in the light squares ahead of the corner along x and behind it, rows
  /// along y and columns along x; null: dark all over. Not owned.
  std::array<const Eigen::MatrixXd*, 2> dark_cells{};
  /// The board around the corner, in squares: how its edges are expected to bend, and where its markers are. Absent:
  /// straight on, as `square`.
  std::optional<LocalPlane> board = std::nullopt;
  /// How far the edges along x (first) and y go on between areas as clean as the squares above, beyond the corner and
  /// before it [squares].
  Eigen::Vector2d clean_ahead = Eigen::Vector2d::Ones(), clean_behind = Eigen::Vector2d::Ones();
  const ColourFilter* filter = nullptr;  ///< the picture's; null: none. Not owned.
};

enum class SaddleStatus { kFitted, kOutsideImage, kNoSaddle, kTooSmall };

struct SaddleFit {
  SaddleStatus status = SaddleStatus::kNoSaddle;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  /// From the fit and the noise that its residual shows.
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Identity();
  Eigen::Vector2d blur_px =
      Eigen::Vector2d::Zero();  ///< across the edges along board x and along board y, pixel included
  /// Directions of the edges along board x and along board y, from the image's x towards its y [rad].
  Eigen::Vector2d edge_rad = Eigen::Vector2d::Zero();
  double contrast = 0.0;      ///< half of light minus dark [grey levels]
  double residual_rms = 0.0;  ///< [grey levels]
  int pixels = 0;
  Eigen::Matrix<double, 12, 1> unknowns =
      Eigen::Matrix<double, 12, 1>::Zero();  ///< the model's, for filter_equations()
};

/// I = (m + c E) (1 + g . p), with E the product of two step edges blurred by a Gaussian: exact also for edges that
/// do not cross at right angles (the bivariate normal orthant). Free: position, both edge directions, both blurs,
/// m, c, g, and the edges' curvature (with a prior, for lens distortion). Levenberg-Marquardt, analytic derivatives.
SaddleFit fit_saddle(const Image8& grey, const SaddleWindow& window);

/// What a window that was fitted without a filter tells of one, less what the corner's own unknowns follow of it.
FilterEquations filter_equations(const Image8& grey, const SaddleWindow& window, const SaddleFit& fit);

}  // namespace rigproof::detection
