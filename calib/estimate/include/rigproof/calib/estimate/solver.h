// Levenberg-Marquardt with iteratively reweighted residuals on a Problem, and the noise levels found on the way.
#pragma once

#include "rigproof/calib/estimate/problem.h"

namespace rigproof::ml {

struct SolverOptions {
  int max_iterations = 60;
  /// Stops when a step is predicted to lower the cost by less than this (1 = a change of one sigma).
  double tolerance = 1e-8;
};

struct SolverSummary {
  bool converged = false;
  int iterations = 0;
  double cost = 0.0;
};

/// Root mean square of the stated sigmas of a camera's corners [px]; 0 without any.
double stated_corner_px(const Observations& observations, int camera);

/// Minimises the problem's cost from the given state.
SolverSummary minimise(const Problem& problem, const SolverOptions& options, State* state);

/// Which levels are estimated; the others are taken as given.
struct EstimatedLevels {
  bool odometry_xy = true;
  bool odometry_yaw = true;
  bool suspension_height = true;
  bool suspension_tilt = true;
  bool corners = true;
  bool planes = true;
  bool displacement = true;
  std::vector<bool> corners_given;  ///< of which cameras the corners' level is taken as given all the same; empty: none
  bool any() const {
    return odometry_xy || odometry_yaw || suspension_height || suspension_tilt || corners || planes || displacement;
  }
};

/// Minimises, re-estimating the levels from the residuals with the redundancy that the unknowns leave (variance
/// components, i.e. restricted maximum likelihood, with the loss's own expectation), until both settle.
SolverSummary minimise_with_levels(const EstimatedLevels& levels, const SolverOptions& options, Problem* problem,
                                   State* state);

/// -2 ln of the restricted likelihood at a minimum, up to a constant that does not depend on the noise model. Every
/// mounting has a prior of one metre and one radian, so undetermined directions contribute the same to every model.
/// Infinite if board or robot poses are not determined either.
double minus_two_log_likelihood(const Problem& problem, const State& state);

}  // namespace rigproof::ml
