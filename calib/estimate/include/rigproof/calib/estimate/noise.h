// Noise levels and the robust loss.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/estimate/odometry_law.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// By how much an image taken at speed is displaced as a whole along and about each axis at least, one sigma: it is the
/// mean of its exposure, not its middle. Of rendered drives of a skid-steered robot and a cart.
inline constexpr double kLeastDisplacement_m = 5e-6, kLeastDisplacement_rad = 1.5e-5;

/// Standard deviations by which residuals are whitened; every one is given or estimated (see solver.h).
struct NoiseLevels {
  OdometryLaw law;
  double odometry_xy_m = 0.002;
  double odometry_yaw_rad = 0.01;
  double suspension_height_m = 5e-4;
  double suspension_tilt_rad = 5e-4;
  std::vector<double> corner_scale;       ///< times the stated sigma of the corners, one a camera
  std::vector<double> ground_scale;       ///< times the stated sigma of the ground planes, one a camera
  std::vector<double> board_plane_scale;  ///< times the stated sigma of the board's planes, one a camera
  double displacement_scale = 1.0;        ///< times the least displacement of images taken at speed
  /// What of the corners' scale comes of images that are displaced as a whole: a factor, one a camera.
  std::vector<double> shaken = {};
};

/// `levels`, none below the smallest plausible one, with corners and planes as uncertain as stated (scales of 1).
NoiseLevels plausible(NoiseLevels levels, std::size_t cameras);

/// Smallest plausible levels: files do not resolve less, and smaller ones would make the equations stiff.
inline constexpr double kMinOdometryXy_m = 1e-5;
inline constexpr double kMinOdometryYaw_rad = 1e-5;
inline constexpr double kMinSuspensionHeight_m = 1e-5;
inline constexpr double kMinSuspensionTilt_rad = 1e-5;

/// Cauchy's loss c^2 log(1 + s / c^2) of a squared whitened residual s.
struct CauchyLoss {
  double c2 = 9.0;
  double cost(double s) const;
  double weight(double s) const { return 1.0 / (1.0 + s / c2); }
};

/// Expectations of the loss for a whitened Gaussian residual of d dimensions (d = 1, 2, 3).
struct LossMoments {
  double weight = 1.0;         ///< E[w]
  double weighted_square = 1;  ///< E[w s] / d: what a residual dimension contributes to the weighted sum of squares
  double efficiency = 1.0;     ///< E[psi']^2 / (E[psi^2] / d): share of the information that the loss keeps
};
/// For c = 3.
const LossMoments& cauchy_moments(int dimensions);

}  // namespace rigproof::ml
