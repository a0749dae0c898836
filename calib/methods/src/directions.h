// Directions from many steps of a drive, and their robust mean.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rigproof::rivals {

inline constexpr std::size_t kMinDirections = 3;

/// Unit vectors that should agree, with weights.
struct Directions {
  std::vector<Eigen::Vector3d> vectors;
  std::vector<double> weights;

  void add(const Eigen::Vector3d& vector, double weight);
  /// Weighted mean under Cauchy's loss at three times the median angle, so that outliers count no more; absent with
  /// fewer than kMinDirections.
  std::optional<Eigen::Vector3d> common() const;
};

}  // namespace rigproof::rivals
