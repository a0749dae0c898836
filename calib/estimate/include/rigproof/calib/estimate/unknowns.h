// The one table of what is unknown beside cameras, board and robot poses: systematic errors of odometry, depth, lenses
// and clocks. Settings, priors, layout, state, covariance and what is reported of them follow from it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// One sigma of each systematic error before any data; 0 = known to be none.
struct PriorSigmas {
  /// Of the odometry (increments only): measured = factor * true, of translations and of turns.
  double odometry_scale = 0.1;
  double odometry_yaw_factor = 0.1;
  /// Of each camera's focal length (relative) and principal point; 0 = the stated intrinsics are believed.
  double focal_relative = 0.0;
  double principal_point_px = 0.0;
  /// Of what the stamps of each camera's images are later than the odometry's clock; 0 = they are believed. Only stops
  /// with a velocity tell it.
  double clock_offset_s = 0.0;
  /// Where clock offsets are estimated: by how much the body may turn later than its wheels (15 ms were seen where
  /// tyres give way; straight ways lag by less than 1 ms), which tells only where the robot drives straight, too.
  double turn_lag_s = 0.0;
  /// Odometry along the way only: how well it is known along x where the point lies that turns leave in place, which
  /// integrated wheels take for the robot's origin. Nothing but a prior tells; all cameras move by as much.
  double rotation_centre_m = 0.0;
  /// How much higher or lower the robot may ride while it moves (0.2 mm were seen on tyres that turns strain). By the
  /// share of stops that move it is in the heights of all cameras, and nothing but a prior tells.
  double riding_height_m = 0.0;
};

/// What an estimate assumes where nothing else is said.
PriorSigmas usual_priors();

namespace ml {

/// A row of the table. A new one needs its name here, its row in unknowns.cpp, its sigma above if users may set it, and
/// its derivative in the factors that it enters.
enum class Nuisance { kOdometryFactors, kDepthScale, kLens, kGroundOffset, kClockOffset, kTurnLag };
inline constexpr std::size_t kNuisances = 6;

/// Where a prior comes from.
struct PriorSource {
  const Observations& observations;
  const PriorSigmas& sigmas;
  bool planes_share_errors;  ///< ground planes that scatter less than stated share what is missing
};

struct NuisanceRow {
  struct Part {
    const char* name;     ///< with the unit in which it is reported
    double units_per_si;  ///< what is reported = this * value
  };
  std::vector<Part> parts;
  bool per_camera;       ///< else one for the whole rig
  bool increments_only;  ///< no residual of absolute odometry knows it
  bool reported;         ///< in Result::also_estimated
  /// Covariance of the prior (parts x parts, mean zero), one a camera or one for the rig; zero = believed.
  std::vector<Eigen::MatrixXd> (*prior)(const PriorSource& source);

  int size() const { return static_cast<int>(parts.size()); }
};
/// By Nuisance. Every value is an error: zero where all is as declared.
const std::array<NuisanceRow, kNuisances>& nuisance_table();
inline const NuisanceRow& row_of(Nuisance nuisance) { return nuisance_table()[static_cast<std::size_t>(nuisance)]; }

/// The priors of all rows.
class Priors {
 public:
  static Priors of(const PriorSource& source);
  Eigen::MatrixXd& covariance(Nuisance nuisance, int camera = 0) {
    return covariances_[static_cast<std::size_t>(nuisance)][static_cast<std::size_t>(camera)];
  }
  const Eigen::MatrixXd& covariance(Nuisance nuisance, int camera = 0) const {
    return covariances_[static_cast<std::size_t>(nuisance)][static_cast<std::size_t>(camera)];
  }
  double sigma(Nuisance nuisance, int camera = 0, int part = 0) const;
  /// Whether any value of the row is not believed.
  bool has(Nuisance nuisance) const;
  /// One for the rig, or one a camera.
  int count(Nuisance nuisance) const {
    return static_cast<int>(covariances_[static_cast<std::size_t>(nuisance)].size());
  }

 private:
  std::array<std::vector<Eigen::MatrixXd>, kNuisances> covariances_;
};

/// Values of all rows, whether they are estimated or not; zero at first.
class NuisanceValues {
 public:
  explicit NuisanceValues(int cameras = 0);
  auto of(Nuisance nuisance, int camera = 0) {
    return values_.segment(address(nuisance, camera), row_of(nuisance).size());
  }
  auto of(Nuisance nuisance, int camera = 0) const {
    return values_.segment(address(nuisance, camera), row_of(nuisance).size());
  }

 private:
  static Eigen::Index address(Nuisance nuisance, int camera);
  Eigen::VectorXd values_;
};

/// An error that no data tell: it moves all cameras alike along an axis of the robot, and adds to their uncertainty.
struct CommonError {
  double PriorSigmas::*sigma_m;
  int axis;
  bool along_way_only;
};
const std::array<CommonError, 2>& common_errors();

}  // namespace ml

/// A prior that users set.
struct PriorSetting {
  const char* key;  ///< with its unit
  double PriorSigmas::*sigma;
  double units_per_si;
  double most;     ///< in the key's unit
  bool estimated;  ///< from the data; else it only widens the uncertainty
  const char* description;
};
const std::vector<PriorSetting>& prior_settings();

}  // namespace rigproof
