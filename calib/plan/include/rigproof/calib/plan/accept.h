// Is a calibration good enough? Gates that need no truth: stated uncertainty, repeatability, prediction.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/diagnose/method.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

struct MlOptions;

/// Limits; one that is absent is not applied. On disk:
///   uncertainty: {xy_mm: 8, z_mm: 4, angle_deg: 0.2}
///   between_cameras: {distance_mm: 2, angle_deg: 0.05}
///   split_half: {max_z: 4}
///   held_out: {folds: 5, max_ratio: 1.5}
struct AcceptCriteria {
  /// On the stated standard deviation of each camera in the robot.
  std::optional<AcceptLimits> uncertainty;
  std::optional<double> between_distance_m;  ///< of each camera in each earlier one
  std::optional<double> between_angle_rad;
  /// On |difference| over its stated standard deviation, of solutions from the first and the second half of the drive.
  std::optional<double> split_half_max_z;
  /// On the whitened chi-square per dimension of images that were left out and predicted by the others: 1 if everything
  /// is as stated.
  std::optional<double> held_out_max_ratio;
  int held_out_folds = 5;
  std::string name;  ///< "default.yaml"
};

/// Throws Error with every problem found; criteria without any limit are a problem.
AcceptCriteria load_accept_criteria(const std::filesystem::path& file);
/// The JSON Schema of such files.
std::string accept_criteria_schema();

/// One gate.
struct AcceptCheck {
  std::string name;  ///< "left in base_footprint: tx", "split half: left", "held-out stops"
  bool passed = false;
  double value = 0.0;
  double limit = 0.0;
  std::string unit;               ///< "mm", "deg", "sigma"; empty for a ratio
  std::optional<Finding> reason;  ///< why it failed without a value
};

struct AcceptReport {
  std::vector<AcceptCheck> checks;
  std::vector<Finding> notes;
  /// At least one check, and none failed.
  bool passed() const;
  std::size_t failures() const;
};

/// Applies the criteria to a result of the method on these observations. A refused degree of freedom fails if its
/// uncertainty is limited, and so does a gate that cannot be checked (a refused half, a method without uncertainty).
/// Solves again for split halves and held-out stops.
AcceptReport check_acceptance(const Method& method, const Result& result, const Observations& observations,
                              const AcceptCriteria& criteria);

/// The observations of the stops `first` <= i < `last` by themselves.
Observations stops_of(const Observations& observations, int first, int last);

/// How well the images of some stops are predicted by those of all others, with the motion between known by odometry
/// alone: whitened chi-square and its expectation, over folds that leave out every n-th stop.
struct HeldOut {
  double chi_square = 0.0;
  double expected = 0.0;
  int stops = 0;  ///< that were left out, all folds together
};
/// Of the model of `ml` with these options, at the noise levels that it estimates. Absent if there are too few stops or
/// no solution.
std::optional<HeldOut> predict_held_out(const Observations& observations, int folds, const MlOptions& asked);

}  // namespace rigproof
