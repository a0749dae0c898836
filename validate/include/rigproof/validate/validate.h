// The answer against the truth.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/result.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Error of one transform, with what the method claimed about it.
struct TransformError {
  std::string parent;
  std::string child;
  Vector6d error = Vector6d::Zero();  ///< chart of transform_error(), metres and radians
  std::optional<Vector6d> sigma;      ///< stated standard deviation
  std::array<bool, 6> observable = {true, true, true, true, true, true};
  std::optional<double> z(int axis) const;  ///< error / sigma
};

/// A wrong convention that would explain a foreign result: "inverse", "optical and body axes swapped", ...
struct ConventionSuspicion {
  std::string explanation;
  double error_if_corrected_m = 0.0;
  double error_if_corrected_rad = 0.0;
};

struct Comparison {
  std::string method;
  ResultStatus status = ResultStatus::kSolved;
  std::vector<TransformError> camera_to_robot;
  std::vector<TransformError> camera_to_camera;
  /// Normalised estimation error squared of all cameras together, error Log(X_hat X^-1); absent without covariance.
  std::optional<double> nees;
  int nees_degrees_of_freedom = 0;
  std::optional<ConventionSuspicion> suspicion;
};

/// Compares a result with the truth. Cameras are matched by name; one that the truth does not know is an Error.
Comparison compare(const Result& result, const Truth& truth);

}  // namespace rigproof
