// The answer against the truth.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/result.h"
#include "rigproof/truth/truth.h"
#include "rigproof/validate/bound.h"

namespace rigproof {

/// Error of one transform, with what the method claimed about it. Parent and child are in the truth's direction
/// (parent robot, child camera; parent camera j, child camera k, j < k in the truth's order), whichever way the result
/// stated them.
struct TransformError {
  std::string parent;
  std::string child;
  Vector6d error = Vector6d::Zero();  ///< chart of transform_error(), metres and radians
  std::optional<Vector6d> sigma;      ///< stated standard deviation
  /// Degrees that the result does not answer are taken from the truth before the error is computed, so theirs is zero.
  std::array<bool, 6> observable = {true, true, true, true, true, true};
  Rigid3 T_estimate;  ///< T_parent_child
  Rigid3 T_true;

  /// error / sigma; absent without sigma, where sigma is zero, or where the degree is not observable.
  std::optional<double> z(int axis) const;
  bool fully_observable() const;
  /// "left in robot", "left-center".
  std::string name() const;
  bool between_cameras = false;
};

/// A wrong convention that would explain a foreign result.
struct ConventionSuspicion {
  Finding convention;  ///< convention.inverted, ..; `because` of it is a second one that occurs with it
  double error_now_m = 0.0;
  double error_now_rad = 0.0;
  double error_if_corrected_m = 0.0;    ///< of the worst camera
  double error_if_corrected_rad = 0.0;  ///< of the worst camera
};

/// Normalised estimation error squared of one camera's pose in the robot frame.
struct CameraNees {
  std::string camera;
  double nees = 0.0;
  int degrees_of_freedom = 6;
};

struct Comparison {
  std::string method;
  ResultStatus status = ResultStatus::kSolved;
  std::vector<Finding> reasons;                 ///< of the result, why it is partial or refused
  std::vector<std::string> cameras;             ///< all of the truth's
  std::vector<TransformError> camera_to_robot;  ///< in the truth's order
  /// As the result states them; composed from camera_to_robot where it does not.
  std::vector<TransformError> camera_to_camera;
  std::vector<std::string> missing_cameras;  ///< in the truth, with no pose in the result
  /// Of all cameras together, error Log(X_hat X^-1); needs the result's joint covariance.
  std::optional<double> nees;
  int nees_degrees_of_freedom = 0;
  std::vector<CameraNees> camera_nees;  ///< of each camera alone that states a covariance
  std::optional<ConventionSuspicion> suspicion;
  std::optional<DataBound> bound;  ///< what the data allow, where the caller knows it; compare() leaves it absent

  /// Largest |error| between cameras.
  double worst_between_m() const;
  double worst_between_rad() const;
};

/// Largest |error| of these, in metres, or in radians.
double worst_error(const std::vector<TransformError>& errors, bool rotation);

/// Compares a result with the truth. Cameras are matched by name; whatever single other name occurs is the robot, and
/// either direction is understood. Throws Error that lists every statement that names no camera of the truth (with the
/// nearest one), two different robots, or a pair twice; `file` is where the result stands, for its messages.
Comparison compare(const Result& result, const Truth& truth, const std::string& file = {});

/// Where the difference of two tracks of transforms is small: looks for the wrong convention that best explains a
/// result. Absent unless correcting it makes the error at least ten times smaller and plausible (at most 0.15 m and
/// 8 degrees for every camera), and the error as stated is gross (2 cm or 2 degrees).
std::optional<ConventionSuspicion> find_convention_suspicion(const std::vector<TransformError>& camera_to_robot);

}  // namespace rigproof
