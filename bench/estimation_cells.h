// One cell of the table: many geometric runs of one kind, and the sums that ratios and limits are made of.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof::bench {

/// Runs that differ in the number of stops and in lambda only.
struct Sheet {
  std::string name = "table";  ///< of its files and headings
  std::string title;
  bool per_pose = false, steps = false, systematics = false, suspension = false, outliers = false;
  bool choose_model = false, estimate_sigmas = false;
  bool known_odometry = false;  ///< scale and track are known to be right: neither is estimated, nor in the bound
  int random_cameras = 0;       ///< 0: the reference scene
  double corner_sigma_px = 0.1;
  std::string method = "ml";
};

struct CellKey {
  Sheet sheet;
  int stops = 0;
  double lambda = 0.0;
  std::uint64_t seed = 0;
  /// Names the cell's file.
  std::string file_name() const;
};

/// Mean squared error and mean bound of one axis, with what is needed for confidence limits.
struct AxisSum {
  double error2 = 0.0, error4 = 0.0, bound2 = 0.0;
  void add(double e2, double b2);
  double ratio() const;
  /// One-sided 99 % limits by the delta method on the mean of squared errors: sign -1 the lower, 1 the upper one.
  double limit(int trials, double sign) const;
};

struct Cell {
  std::array<AxisSum, 6> robot, pair;
  int trials = 0, solved = 0, refused = 0, wrong_model = 0;
  double nees = 0.0, nees2 = 0.0, seconds = 0.0;

  double mean_nees() const { return nees / solved; }
  /// Half of the two-sided 99 % interval of the mean.
  double nees_limit() const;
  /// Largest lower 99 % limit of all axes: what the goal is about.
  double worst_lower_limit() const;
};

/// The seed of trial k is the key's seed plus k.
GeometricConfig configuration(const CellKey& key, int trial);
/// What is declared is what is true; sheets that estimate declare nothing.
MlOptions method_options(const CellKey& key, const GeometricConfig& config);
void add_trial(const CellKey& key, int trial, Cell* cell);

/// The optimum that the start from the data alone leads to, against that of the start from the truth.
struct ConvergenceTrial {
  double cost_from_data = 0.0, cost_from_truth = 0.0;
  bool same_optimum = false;  ///< from the data to no higher cost
  bool settled = false;       ///< both iterations ended by themselves
};
ConvergenceTrial compare_starts(const CellKey& key, const GeometricConfig& config);

/// A cell that was never saved is empty. Throws Error.
Cell load_cell(const std::filesystem::path& folder, const CellKey& key);
void save_cell(const std::filesystem::path& folder, const CellKey& key, const Cell& cell);

}  // namespace rigproof::bench
