// Options of the maximum-likelihood estimate.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "rigproof/calib/estimate/information.h"

namespace rigproof {

/// Largest standard deviations at which a degree of freedom still counts as answered.
struct PosteriorLimits {
  double xy_m = 0.05;
  double z_m = 0.02;
  double yaw_rad = 0.0349;
  double tilt_rad = 0.00873;
  /// Of tx ty tz rx ry rz.
  std::array<double, 6> each() const { return {xy_m, xy_m, z_m, tilt_rad, tilt_rad, yaw_rad}; }
};
namespace ml {
struct RemovedErrors;
}

struct MlOptions {
  /// Standard deviations of the suspension's slack about the plane; absent: estimated.
  std::optional<double> suspension_height_sigma_m;
  std::optional<double> suspension_tilt_sigma_rad;
  /// NoiseLevels::displacement_scale; absent: estimated.
  std::optional<double> displacement_scale;
  /// Whether the stated covariances of corners and planes are scaled to what the residuals show, per camera.
  bool estimate_corner_level = true;
  bool estimate_plane_level = true;
  PriorSigmas priors = usual_priors();
  /// Declared odometry noise is along the way (OdometryLaw::along_way). If no model is declared, this one is tried
  /// when the observations contain the ways.
  bool along_way = false;
  /// Of declared noise along the way: OdometryLaw::metre_as_turn_rad.
  double metre_as_turn_rad = OdometryLaw().metre_as_turn_rad;
  PosteriorLimits limits;
  /// Where to start instead of the closed-form guess.
  std::optional<CalibrationState> start;
  /// How large errors that repeat in every image are, if more images of the same cameras and boards tell it; null:
  /// estimated.
  std::shared_ptr<const ml::RemovedErrors> repeating;
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

}  // namespace rigproof
