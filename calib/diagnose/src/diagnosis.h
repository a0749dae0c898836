// The likely cause of a contradiction: each fault is undone in turn, and the data judge what is left.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "lens_check.h"
#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"
#include "yaw_drift.h"

namespace rigproof::ml {

/// The solution of a run whose fault was undone.
struct Trial {
  /// -2 ln of the restricted likelihood; what was left out counts as very wrong. Infinite if there is no solution, or
  /// none that is worth looking for.
  double unexplained = std::numeric_limits<double>::infinity();
  double start_misfit = std::numeric_limits<double>::infinity();  ///< see start_misfit()
  double odometry_xy_m = 0.0;
  double odometry_yaw_rad = 0.0;
  bool clean = false;   ///< nothing contradicts itself any more
  bool shakes = false;  ///< but images of some camera are displaced as a whole, see shaking.h
  std::optional<LensTest> lenses;
  std::vector<double> lens_strains;  ///< of each camera, see lens_strains()
  bool solved() const { return std::isfinite(unexplained); }
};
/// @param same_views whether only the odometry was changed, so that the board's poses in the views still hold
/// @param as_is of the data as they are: what is_hopeless() beside it is not solved; null: whatever is asked
using Refit = std::function<std::optional<Trial>(const Observations&, bool same_views, const Trial* as_is)>;

/// The contradictions in the solution.
struct Symptoms {
  bool odometry = false;
  bool lenses = false;
  std::vector<bool> bad_corners;  ///< cameras whose corners are far off
  bool frames = false;            ///< many views of a camera had to be left out
  double stops_ahead = 0.0;       ///< of the odometry, by the residuals' slope
  double odometry_scale = 1.0;    ///< if it were free
  double odometry_yaw_factor = 1.0;
  YawDrift yaw_drift;
  /// Cameras whose depth of the board is so many times what their corners say, or both for all: focal lengths may be.
  std::vector<std::pair<std::vector<int>, double>> depth_ratios;
  bool any() const { return odometry || lenses || frames; }
};

/// With `undone_mm` and `undone_deg`: how well odometry and cameras agree without it.
struct Cause {
  std::vector<Finding> findings;  ///< one, or more where the data do not tell them apart (`joined_by`)
  bool spoils_all = false;
  double gain = 0.0;  ///< by how much -2 ln of the likelihood falls without it, over the stops that are examined
  bool leaves_shaking = false;  ///< images of some camera remain displaced as a whole: that may be all there is
};

/// The most likely cause, or several where the data do not tell them apart; absent if none leaves the data in order.
std::optional<Cause> find_cause(const Observations& observations, const Symptoms& symptoms, const Refit& refit);

/// The same of images that are mirrored and of folders that are exchanged alone, which is soon asked.
std::optional<Cause> find_cause_in_images(const Observations& observations, const Refit& refit);

/// Number of stops that are examined: causes act on all stops alike.
inline constexpr int kDiagnosedStops = 24;

}  // namespace rigproof::ml
