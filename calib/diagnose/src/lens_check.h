// Whether the corners contradict the stated focal length and principal point, and how well they are said to be known: a
// score test at a solution.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/calib/estimate/problem.h"

namespace rigproof::ml {

/// Of focal length and principal point together, before the intrinsics are doubted.
inline constexpr double kLensMinDeviations = 5.0;

/// Relative error of the focal length, shift of cx and of cy [px]: one step from the stated intrinsics.
struct LensEstimate {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Constant(1e9);
  double deviations = 0.0;  ///< of all three together from zero
  /// Inverse covariance; zero where a value is believed.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// Beyond five standard deviations (chance: one in 70,000), and beyond the usual error of calibrations and prints
  /// (1 %, 0.25 px).
  bool contradicts() const;
  /// Worth a second look: the same from 2.5 standard deviations (chance: one in 23 for a shift).
  bool may_contradict() const;
  /// Of intrinsics that have already been moved by this much.
  void move_by(const Eigen::Vector3d& moved);
};

struct LensTest {
  std::vector<LensEstimate> alone;  ///< per camera, the other cameras' intrinsics being as stated
  LensEstimate common;              ///< one error that all cameras share
  LensEstimate common_shift;        ///< the same, the focal lengths being as stated
  bool suspicious() const;
};

/// Priors of a camera whose intrinsics are in doubt.
inline constexpr double kDoubtedFocal = 0.2;
inline constexpr double kDoubtedPrincipalPoint_px = 50.0;

/// The same priors with every camera's focal length and principal point in doubt.
Priors with_doubted_lenses(Priors priors);

/// @param problem with doubted lenses
/// @param repeating what was taken out of its corners: what is left of it counts as unknown
/// @param stated the priors of the solution: an estimate is an error beyond them, and its sigma counts theirs
/// Absent where the data do not determine the rest.
std::optional<LensTest> test_lenses(const Problem& problem, const RemovedErrors& repeating, const Priors& stated,
                                    const State& state);

}  // namespace rigproof::ml
