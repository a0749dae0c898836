// One odometry model's solution of a preparation.
#pragma once

#include <vector>

#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/calib/estimate/solver.h"

namespace rigproof::ml {

struct Fit {
  NoiseLevels noise;
  State state;
  std::vector<bool> view_left_out;
  Step step;  ///< that the state's second poses are of
  SolverSummary summary;
  double minus_two_log_likelihood = 0.0;
  /// Of each camera whose images are displaced as a whole from stop to stop, by how much [px]; else 0. Empty: not
  /// asked.
  std::vector<double> shaken_px;
};

/// Which levels are estimated: all that nobody states.
EstimatedLevels estimated_levels(const Observations& observations, const MlOptions& options);

/// Rounds in which wrong views are left out: one for each camera at a stop.
inline constexpr int kLeaveOutRounds = 8;

/// @param other the other model's solution, if there is one: it differs by the odometry only
Fit fit_model(const Preparation& prepared, const OdometryLaw& law, int leave_out_rounds = kLeaveOutRounds,
              const Fit* other = nullptr);

/// Errors that repeat in every image, anew from a solution without a prior that the preparation has got since.
void settle_again(Preparation* prepared, const Fit& before);
/// From a solution, with the same views, after the priors have changed: cameras that shake keep their level.
Fit fit_again(const Preparation& prepared, const Fit& before);

/// The same from a solution, with second poses of the step's bodies, and with the views again that it left out.
Fit fit_with_step(const Preparation& prepared, const Fit& without, const Step& step);

/// The problem as it stands at a solution: its views left out, with the given levels.
Problem problem_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels, const Priors& priors);
Problem problem_at(const Preparation& prepared, const Fit& fit, const NoiseLevels& levels);

}  // namespace rigproof::ml
