// Sums over each group of residuals, from which noise levels are estimated and contradictions are found.
#pragma once

#include <array>
#include <vector>

namespace rigproof::ml {

enum class Group {
  kCorners,
  kGround,
  kBoardPlane,
  kOdometryXy,
  kOdometryYaw,
  kSuspensionHeight,
  kSuspensionTilt,
  kDisplacement  ///< of images taken at speed
};
inline constexpr std::size_t kGroupCount = 8;

/// Sums over the residuals of a group, whitened by the current noise levels.
struct GroupSum {
  double square = 0.0;                   ///< of r
  double weighted_square = 0.0;          ///< of w r^2
  double weight = 0.0;                   ///< of w, a dimension
  double leverage = 0.0;                 ///< dimensions that the unknowns absorb
  double dimensions = 0.0;               ///< of correlated residuals each group has its share
  double outlier_weighted_square = 0.0;  ///< the part of residuals that no noise explains
  double outlier_dimensions = 0.0;

  GroupSum& operator+=(const GroupSum& other);
  /// Adds a residual with its weight by the loss.
  void add(double whitened_square, double weight, double dimensions);
  /// Dimensions that the unknowns do not absorb.
  double redundancy() const { return dimensions - leverage; }
  /// Without the outliers, if they are few: even under a bounded loss each of them would count like several residuals.
  GroupSum without_outliers() const;
};
/// [group][camera]; groups without cameras use camera 0.
using GroupSums = std::array<std::vector<GroupSum>, kGroupCount>;
inline GroupSum& sum_of(GroupSums& sums, Group group, int camera = 0) {
  return sums[static_cast<std::size_t>(group)][static_cast<std::size_t>(camera)];
}
inline const GroupSum& sum_of(const GroupSums& sums, Group group, int camera = 0) {
  return sums[static_cast<std::size_t>(group)][static_cast<std::size_t>(camera)];
}

}  // namespace rigproof::ml
