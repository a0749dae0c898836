// Maximum likelihood: all extrinsics, board, robot poses and nuisances together, at the statistical limit.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/diagnose/observability.h"
#include "rigproof/calib/estimate/ml_options.h"
#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

struct MlEstimate {
  Result result;
  CalibrationState state;            ///< at the optimum; empty if there was nothing to solve
  CalibrationNoise noise;            ///< levels that were given or estimated
  std::vector<double> corner_scale;  ///< of the stated corner sigmas, per camera
  std::vector<double> ground_scale;  ///< of the stated ground planes' sigmas
  std::vector<double> board_plane_scale;
  double displacement_scale = 1.0;  ///< of the least displacement of images taken at speed
  OdometryDecision odometry;
  MotionVerdict motion;
  /// What in the observations contradicts the rest, likely causes first; each is one of the result's reasons, too.
  std::vector<Finding> contradictions;
  bool only_odometry_contradicts = false;  ///< by the likely cause: what the images show is in order
  /// What repeats in every image, as it was found, and the observations' board views without it; null where lenses and
  /// boards are believed.
  std::shared_ptr<const ml::RemovedErrors> repeating;
  std::vector<BoardView> views_without_repeating;
  double cost = 0.0;  ///< robust, whitened
  int iterations = 0;
  bool converged = false;
};

/// Never throws on data; see Method::solve().
MlEstimate estimate_maximum_likelihood(const Observations& observations, const MlOptions& options = {});

/// The method `ml` of the registry.
const Method& ml_method();

}  // namespace rigproof
