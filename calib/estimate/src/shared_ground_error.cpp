#include "shared_ground_error.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "planes_of_cameras.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

// Of the stated variance: sensors' noise laws are not known better.
constexpr double kClearlyLess = 0.5;
constexpr double kHardlyAny = 1e-6;     // a prior must have an inverse
constexpr double kContradicts = 16.27;  // chi-square of three dimensions, exceeded once in a thousand
constexpr std::size_t kMinPlanes = 5;   // fewer scatter in three directions by chance alone

Eigen::Matrix3d mean_covariance(const PlanesOfCamera& planes) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (const PlaneObservation* plane : planes) mean += plane->covariance_per_m2 / static_cast<double>(planes.size());
  return mean;
}

Eigen::Vector3d median_of_each_axis(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    result[axis] = median(std::move(values));
  }
  return result;
}

// Differences of planes to their median, in units of what is stated: whitened by the mean covariance, and longer or
// shorter where less or more than the mean is stated for the plane. What contradicts the others is left out. The median
// is taken in these units, where the axes err independently: otherwise one wild plane makes each component the median
// of another plane, which together lie on none.
std::vector<Eigen::Vector3d> whitened_differences(const PlanesOfCamera& planes, const Eigen::Matrix3d& mean_factor) {
  const auto whitened = [&mean_factor](const Eigen::MatrixXd& value) -> Eigen::MatrixXd {
    return mean_factor.triangularView<Eigen::Lower>().solve(value);
  };
  std::vector<Eigen::Vector3d> points;
  for (const PlaneObservation* plane : planes)
    points.emplace_back(whitened(plane->inverse_depth_plane - planes.front()->inverse_depth_plane));
  const Eigen::Vector3d centre = median_of_each_axis(points);
  std::vector<Eigen::Vector3d> differences;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Eigen::Matrix3d stated = whitened(whitened(planes[i]->covariance_per_m2).transpose());
    const Eigen::Vector3d difference = (points[i] - centre) * std::sqrt(3.0 / stated.trace());
    if (difference.squaredNorm() < kContradicts) differences.push_back(difference);
  }
  return differences;
}

// Chance makes the least of three directions scatter less than this once in a thousand: Wilson and Hilferty's
// chi-square, at four sigmas for the choice of the direction (played through: within 3 % from 12 planes on, and fewer
// planes more seldom).
double scatter_by_chance(std::size_t planes) {
  const double spread = 2.0 / (9.0 * static_cast<double>(planes - 1));
  return std::pow(std::max(0.0, 1.0 - spread - 4.0 * std::sqrt(spread)), 3);
}

// Direction by direction: a level camera's rows are rounded alike in height, and anyhow in tilt.
Eigen::Matrix3d shared_error(const PlanesOfCamera& planes) {
  Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  if (planes.size() < kMinPlanes) return none;
  const Eigen::Matrix3d factor = mean_covariance(planes).llt().matrixL();
  const std::vector<Eigen::Vector3d> differences = whitened_differences(planes, factor);
  if (differences.size() < kMinPlanes) return none;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& difference : differences) sum += difference * difference.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> scatter(sum / static_cast<double>(differences.size() - 1));
  const double limit = kClearlyLess * scatter_by_chance(differences.size());
  const Eigen::Array3d shares = 1.0 - scatter.eigenvalues().array() / limit;
  if (!(shares.maxCoeff() > 0.0)) return none;
  const Eigen::Matrix3d directions = factor * scatter.eigenvectors();
  return directions * shares.max(kHardlyAny).matrix().asDiagonal() * directions.transpose();
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
