// Maximum likelihood: all extrinsics, board, robot poses and nuisances together, at the statistical limit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/information.h"
#include "rigproof/calib/method.h"
#include "rigproof/calib/observability.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

struct MlOptions {
  /// Standard deviations of the suspension's slack about the plane; absent: estimated.
  std::optional<double> suspension_height_sigma_m;
  std::optional<double> suspension_tilt_sigma_rad;
  /// Whether the stated covariances of corners and planes are scaled to what the residuals show, per camera.
  bool estimate_corner_level = true;
  bool estimate_plane_level = true;
  /// Priors of the odometry's systematic errors (increments only), one sigma; 0 = none are assumed.
  double odometry_scale_sigma = 0.1;
  double odometry_yaw_factor_sigma = 0.1;
  /// Declared odometry noise is that along the way (CalibrationNoise::along_way). Where no model is declared, that is
  /// tried if the observations know the ways.
  bool along_way = false;
  /// Priors of focal length (relative) and principal point; 0 = the stated intrinsics are believed.
  double focal_relative_sigma = 0.0;
  double principal_point_sigma_px = 0.0;
  /// Prior of what the stamps of each camera's images are later than the odometry's clock; 0 = they are believed. Only
  /// stops with a velocity tell it.
  double clock_offset_sigma_s = 0.0;
  /// Where clock offsets are estimated: by how much the body may turn later than its wheels (15 ms were seen where
  /// tyres give way; straight ways lag by less than 1 ms), which tells only where the robot drives straight, too.
  double turn_lag_sigma_s = 0.02;
  /// Odometry along the way only: how well it is known along x where the point lies that turns leave in place, which
  /// integrated wheels take for the robot's origin. Nothing but a prior tells; all cameras move by as much.
  double rotation_centre_sigma_m = 0.005;
  /// How much higher or lower the robot may ride while it moves (0.2 mm were seen on tyres that turns strain). By the
  /// share of stops that move it is in the heights of all cameras, and nothing but a prior tells.
  double riding_height_sigma_m = 0.0003;
  PosteriorLimits limits;
  /// Where to start instead of the closed-form guess.
  std::optional<CalibrationState> start;
  /// Steps below this fraction of a standard deviation (squared) end the iteration.
  double tolerance = 1e-8;
};

/// How sure the choice between the two odometry models is.
struct OdometryDecision {
  bool decided_from_data = false;
  OdometryModel model = OdometryModel::kPerIncrement;
  bool along_way = false;             ///< increments whose noise grows along the way
  bool compared = false;              ///< decided from data that tell how likely the models are, as below
  double log_likelihood_ratio = 0.0;  ///< ln of the ratio to the next best model, >= 0
  double probability = 1.0;           ///< of this model, both being equally likely beforehand
};

struct MlEstimate {
  Result result;
  CalibrationState state;            ///< at the optimum; empty if there was nothing to solve
  CalibrationNoise noise;            ///< levels that were given or estimated
  std::vector<double> corner_scale;  ///< of the stated corner sigmas, per camera
  std::vector<double> ground_scale;  ///< of the stated ground planes' sigmas
  std::vector<double> board_plane_scale;
  OdometryDecision odometry;
  MotionVerdict motion;
  /// What in the observations contradicts the rest, likely causes first; each is one of the result's reasons, too.
  std::vector<std::string> contradictions;
  bool only_odometry_contradicts = false;  ///< by the likely cause: what the images show is in order
  double cost = 0.0;                       ///< robust, whitened
  int iterations = 0;
  bool converged = false;
};

/// Never throws on data; see Method::solve().
MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options = {});

/// The method `ml` of the registry.
const Method& ml_method();

}  // namespace rigproof
