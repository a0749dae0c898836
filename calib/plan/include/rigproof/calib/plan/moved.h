// Has a camera shifted since a previous calibration? A test at a stated significance, from a handful of images.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof {

struct MovedOptions {
  /// Probability of a false alarm when nothing moved, for all cameras together.
  double significance = 1e-3;
  /// Shifts of one camera that the test must find with 90 % probability; otherwise the camera's verdict is "cannot
  /// tell".
  double smallest_shift_m = 0.02;
  double smallest_turn_rad = 0.00873;
  /// Standard deviations of the suspension; absent: estimated, and at least nominal, since few stops hardly determine
  /// it.
  std::optional<double> suspension_height_sigma_m;
  std::optional<double> suspension_tilt_sigma_rad;
};

enum class MovedVerdict {
  kStands,
  kMoved,
  kSuspect,     ///< something moved, and this camera is one of those that would explain it
  kCannotTell,  ///< a shift worth knowing would not show
};
const char* moved_verdict_name(MovedVerdict verdict);

struct CameraShift {
  std::string camera;
  MovedVerdict verdict = MovedVerdict::kCannotTell;
  /// If this camera moved: new pose minus old one, in the chart of transform_error() (tx ty tz rx ry rz along the
  /// robot's axes), and its standard deviations; absent where the data do not determine it. Where others moved and this
  /// one stands, beside their shift.
  std::array<std::optional<double>, 6> shift;
  std::array<std::optional<double>, 6> sigma;
  double p_value = 1.0;  ///< that noise shows as large a shift of this camera, the others standing (or moved as found)
  /// Smallest shifts that the test finds with 90 % probability in the worst direction; infinite if it finds none in
  /// some direction.
  double detectable_shift_m = 0.0;
  double detectable_turn_rad = 0.0;
};

enum class MovedOutcome { kNothingMoved, kMoved, kCannotTell };

struct MovedReport {
  MovedOutcome outcome = MovedOutcome::kCannotTell;
  std::vector<CameraShift> cameras;  ///< those of the previous result, unseen ones last
  bool rig_moved = false;            ///< all cameras together, as one body, explain it best
  double statistic = 0.0;            ///< chi-square if nothing moved
  int degrees_of_freedom = 0;
  double p_value = 1.0;  ///< that noise alone differs as much
  std::vector<Finding> reasons;
  std::vector<Finding> notes;
};

/// Solves the new observations with all cameras free, starting at the previous result, and compares the directions that
/// both determine: the difference, whitened by the sum of both covariances, is chi-square if nothing moved. If it is
/// too large, the smallest set of cameras (or the rig as one body) whose shift explains it is named; others that
/// explain it about as well (likelihood ratio below 100) are suspects. With one stop, or poor odometry, cameras are
/// compared only with each other and with the ground. See docs/theory/moved.md.
/// Throws Error if the previous result states no uncertainty, or contains none of the cameras.
MovedReport detect_movement(const Result& previous, const Observations& observations, const MovedOptions& options = {});

}  // namespace rigproof
