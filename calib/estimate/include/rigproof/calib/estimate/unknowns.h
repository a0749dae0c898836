// The one table of the unknowns beside cameras, board and robot poses: systematic errors of odometry, depth, lenses,
// board and clocks. Settings, priors, layout, state, covariance and report follow from it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// One sigma of each systematic error before any data; 0 = known to be none.
struct PriorSigmas {
  /// Of the odometry (increments only): measured = factor * true, of translations and of turns.
  double odometry_scale = 0.1;
  double odometry_yaw_factor = 0.1;
  /// Of the heading that increments gain over the robot's with every metre forward, and lose backward: wheels of
  /// unequal diameters (UMBmark's E_d), 1 % on a track of 0.3 m.
  double odometry_veer_rad_per_m = 0.0;
  /// Whether what the rig states of lenses and board is believed to the last digit, whatever sigmas it states.
  bool believe_told = false;
  /// Of each camera's focal length (relative) and principal point, in place of the rig's; 0 = as the rig states.
  double focal_relative = 0.0;
  double principal_point_px = 0.0;
  /// Of the delay of each camera's stamps against the odometry's clock, in place of the rig's; 0 = as the rig states,
  /// or believed where that was asked for.
  /// Only stops with a velocity determine it.
  double clock_offset_s = 0.0;
  /// With clock offsets only: of the delay between the turning of the wheels and of the body (15 ms measured on soft
  /// tyres; less than 1 ms when driving straight). Needs straight driving, too, to be separated from the clock offsets.
  double turn_lag_s = 0.0;
  /// Images taken while the robot moves: of the time from a camera's first row to its last (rolling shutter), in place
  /// of the rig's; 0 = as the rig states.
  double readout_s = 0.0;
  /// Odometry along the way only: of the position along x, and along y, of the point about which the robot turns, which
  /// integrated wheel odometry takes for the robot's origin. Known by the prior alone; it shifts all cameras alike.
  double rotation_centre_m = 0.0;
  /// Of the change in the robot's height on its tyres while it moves (0.2 mm measured while turning). Known by the
  /// prior alone; it enters the heights of all cameras, scaled by the share of stops at which the robot moves.
  double riding_height_m = 0.0;
  /// Those that were asked for: they count whatever the rig states, also where they are the usual ones.
  std::vector<double PriorSigmas::*> asked = {};
};

/// Whether one of them was asked for.
bool was_asked(const PriorSigmas& sigmas, double PriorSigmas::*which);
/// The priors of an estimate without settings.
PriorSigmas usual_priors();
/// As the rig states them, where they are the usual ones and were not asked for.
PriorSigmas with_those_of_rig(PriorSigmas sigmas, const OdometryNoise& stated);

namespace ml {

/// A row of the table. A new one needs its name here, its row in unknowns.cpp, its sigma above if users may set it, and
/// its derivative in the factors that it enters.
enum class Nuisance {
  kOdometryFactors,
  kOdometryVeer,
  kDepthScale,
  kCommonDepthScale,
  kDepthOffset,
  kDepthShape,
  kLens,
  kBoardShape,
  kGroundOffset,
  kClockOffset,
  kTurnLag,
  kReadout
};
inline constexpr std::size_t kNuisances = 12;

/// Where a prior comes from.
struct PriorSource {
  const Observations& observations;
  const PriorSigmas& sigmas;
  bool planes_share_errors;  ///< ground planes that scatter less than stated share what is missing
};

/// What a row of the table has one of.
enum class Each { kRig, kCamera, kBoard };
inline int count_of(Each each, int cameras, int boards) {
  return each == Each::kCamera ? cameras : each == Each::kBoard ? boards : 1;
}

struct NuisanceRow {
  struct Part {
    const char* name;     ///< with the unit in which it is reported
    double units_per_si;  ///< what is reported = this * value
    /// By how much it is another one the next day, one sigma; absent: nothing is known of tomorrow's.
    std::optional<double> drift = std::nullopt;
  };
  std::vector<Part> parts;
  Each each;             ///< whole rig, camera or board
  bool increments_only;  ///< no residual of absolute odometry knows it
  bool reported;         ///< in Result::also_estimated
  const char* source;    ///< of uncertainty: what its prior is called in the budget
  /// Covariance of the prior (parts x parts, mean zero) of each; zero = believed.
  std::vector<Eigen::MatrixXd> (*prior)(const PriorSource& source);

  int size() const { return static_cast<int>(parts.size()); }
  /// Whether another drive of the same robot meets the same values.
  bool lasts() const { return parts.front().drift.has_value(); }
};
/// What a quantity of a board is called: board_size_percent of the second one board_2_size_percent.
std::string name_of_board(const std::string& quantity, int board);

/// By Nuisance. Every value is an error: zero where all is as declared.
const std::array<NuisanceRow, kNuisances>& nuisance_table();
inline const NuisanceRow& row_of(Nuisance nuisance) { return nuisance_table()[static_cast<std::size_t>(nuisance)]; }

/// The priors of all rows.
class Priors {
 public:
  static Priors of(const PriorSource& source);
  /// @param which camera or board
  Eigen::MatrixXd& covariance(Nuisance nuisance, int which = 0) {
    return covariances_[static_cast<std::size_t>(nuisance)][static_cast<std::size_t>(which)];
  }
  const Eigen::MatrixXd& covariance(Nuisance nuisance, int which = 0) const {
    return covariances_[static_cast<std::size_t>(nuisance)][static_cast<std::size_t>(which)];
  }
  double sigma(Nuisance nuisance, int which = 0, int part = 0) const;
  /// Whether any value of the row is not believed.
  bool has(Nuisance nuisance) const;
  /// One for the rig, or one a camera or board.
  int count(Nuisance nuisance) const {
    return static_cast<int>(covariances_[static_cast<std::size_t>(nuisance)].size());
  }

 private:
  std::array<std::vector<Eigen::MatrixXd>, kNuisances> covariances_;
};

/// Values of all rows, whether they are estimated or not; zero at first.
class NuisanceValues {
 public:
  explicit NuisanceValues(int cameras = 0, int boards = 1);
  /// @param which camera or board
  auto of(Nuisance nuisance, int which = 0) {
    return values_.segment(address(nuisance, which), row_of(nuisance).size());
  }
  auto of(Nuisance nuisance, int which = 0) const {
    return values_.segment(address(nuisance, which), row_of(nuisance).size());
  }

 private:
  Eigen::Index address(Nuisance nuisance, int which) const;
  int cameras_ = 0;
  Eigen::VectorXd values_;
};

/// The error that the depth scales of cameras of one make have in common: a value of the first of them.
struct CommonDepth {
  int camera;    ///< whose value it is
  double share;  ///< how much of it the camera that is asked about has, 0 to 1: none where its scale is stated as exact
};
CommonDepth common_depth(const Observations& observations, int camera);

/// An error that no data determine: it moves all cameras alike along an axis of the robot, and adds to their
/// uncertainty.
struct CommonError {
  double PriorSigmas::*sigma_m;
  int axis;
  bool along_way_only;
  const char* source;  ///< in the budget
};
const std::array<CommonError, 3>& common_errors();

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
