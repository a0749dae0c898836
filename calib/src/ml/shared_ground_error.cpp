#include "ml/shared_ground_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "methods/planes_of_cameras.h"

namespace rigproof::ml {
namespace {

// Of the stated variance: sensors' noise laws are not known better.
constexpr double kClearlyLess = 0.5;
constexpr double kMedianSquare = 2.366;    // of a whitened residual of three dimensions
constexpr double kMedianEfficiency = 0.5;  // of a median's variance, against the mean's
constexpr std::size_t kMinPlanes = 3;

// Variance of planes about each other, over what is stated.
double scatter(const PlanesOfCamera& planes) {
  const Eigen::Vector3d centre = median_plane(planes);
  std::vector<double> squares;
  for (const PlaneObservation* plane : planes) {
    const Eigen::Vector3d difference = plane->inverse_depth_plane - centre;
    squares.push_back(difference.dot(plane->covariance_per_m2.ldlt().solve(difference)));
  }
  return median_of(std::move(squares)) / kMedianSquare;
}

// Chance makes the scatter less than this once in a thousand (Wilson and Hilferty's chi-square).
double scatter_by_chance(std::size_t planes) {
  const double spread = 2.0 / (9.0 * kMedianEfficiency * 3.0 * static_cast<double>(planes - 1));
  return std::pow(std::max(0.0, 1.0 - spread - 3.0 * std::sqrt(spread)), 3);
}

Eigen::Matrix3d shared_error(const PlanesOfCamera& planes) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  if (planes.size() < kMinPlanes) return mean;
  const double share = 1.0 - scatter(planes) / (kClearlyLess * scatter_by_chance(planes.size()));
  if (!(share > 0.0)) return mean;
  for (const PlaneObservation* plane : planes) mean += plane->covariance_per_m2 / static_cast<double>(planes.size());
  return share * mean;
}

}  // namespace

std::vector<Eigen::Matrix3d> shared_ground_errors(const Observations& observations) {
  std::vector<Eigen::Matrix3d> shared;
  bool any = false;
  for (const PlanesOfCamera& planes : planes_of_cameras(observations.ground_planes, observations.cameras.size())) {
    shared.push_back(shared_error(planes));
    any = any || shared.back().norm() > 0.0;
  }
  return any ? shared : std::vector<Eigen::Matrix3d>();
}

}  // namespace rigproof::ml
