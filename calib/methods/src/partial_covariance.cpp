#include "partial_covariance.h"

#include <cmath>

#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// Suspension and an uneven floor, per stop.
constexpr double kTiltFloor_rad = 3e-4;
constexpr double kHeightFloor_m = 5e-4;
constexpr double kMedianLoss = 1.2533;  // sigma of a median over that of a mean

struct GroundUncertainty {
  int planes = 0;
  double height_variance = 0.0;
  Eigen::Matrix3d up_covariance = Eigen::Matrix3d::Zero();  // of the mean normal, camera's axes
};

GroundUncertainty ground_uncertainty(const Observations& observations, int camera,
                                     const std::vector<PlaneObservation>& ground) {
  GroundUncertainty result;
  double height_sum = 0.0, mean_height = 0.0;
  Eigen::Vector3d mean_plane = Eigen::Vector3d::Zero();
  for (const PlaneObservation& plane : ground) {
    if (plane.camera != camera) continue;
    const double length = plane.inverse_depth_plane.norm();
    const Eigen::Vector3d normal = plane.inverse_depth_plane / length;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - normal * normal.transpose();
    result.up_covariance += across * plane.covariance_per_m2 * across / (length * length);
    result.up_covariance += kTiltFloor_rad * kTiltFloor_rad * across;
    const PlaneHeight height = height_above(plane);
    height_sum += height.sigma_m * height.sigma_m + kHeightFloor_m * kHeightFloor_m;
    mean_height += height.height_m;
    mean_plane += plane.inverse_depth_plane;
    ++result.planes;
  }
  if (result.planes == 0) return result;
  const double n = result.planes;
  result.up_covariance /= n * n;
  mean_height /= n;
  mean_plane /= n;
  const auto index = static_cast<std::size_t>(camera);
  const std::optional<DepthStream>& depth = observations.cameras[index].depth;
  const double scale = (depth ? depth->noise.scale_sigma : 0.0) * mean_height;
  result.height_variance = kMedianLoss * kMedianLoss * height_sum / (n * n) + scale * scale;
  const std::vector<Eigen::Matrix3d> biases = ground_plane_biases(observations);
  if (biases.empty()) return result;
  const Eigen::Vector3d normal = mean_plane.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - normal * normal.transpose();
  result.height_variance += std::pow(mean_height, 4) * normal.dot(biases[index] * normal);
  result.up_covariance += std::pow(mean_height, 2) * across * biases[index] * across;
  return result;
}

// Scatter of the odometry's path across the seen one, over its length.
double yaw_variance(const Observations& observations, const InitialGuess& guess) {
  const std::vector<Rigid3> odometry = odometry_poses(observations);
  double across = 0.0, length = 0.0;
  int motions = 0;
  for (std::size_t i = 1; i < guess.T_world_robot.size(); ++i) {
    const Eigen::Vector3d seen = (guess.T_world_robot[i - 1].inverse() * guess.T_world_robot[i]).translation;
    const Eigen::Vector3d driven = (odometry[i - 1].inverse() * odometry[i]).translation;
    const double square = driven.head<2>().squaredNorm();
    if (square < 1e-8) continue;
    const double off = (seen.x() * driven.y() - seen.y() * driven.x()) / std::sqrt(square);
    across += off * off;
    length += square;
    ++motions;
  }
  if (motions < 2) return kPi * kPi;
  return across / (motions - 1) / length;
}

// Of the mean heading that the views of a camera show; their robust weights lose some of it.
double heading_variance(const std::vector<ViewPose>& views, int camera, const Rigid3& T_robot_camera) {
  constexpr double kWeightsLose = 2.0;
  const Eigen::Vector3d up = T_robot_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  double sum = 0.0, n = 0.0;
  for (const ViewPose& view : views) {
    if (view.camera != camera) continue;
    sum += up.dot(view.covariance.bottomRightCorner<3, 3>() * up);
    n += 1.0;
  }
  return n > 0.0 ? kWeightsLose * sum / (n * n) : kPi * kPi;
}

}  // namespace

Matrix6d partial_covariance(const Observations& observations, const std::vector<ViewPose>& views, int camera,
                            const Rigid3& T_robot_camera, const TrajectoryAlignment& alignment,
                            const std::vector<PlaneObservation>& ground, const InitialGuess& guess) {
  const GroundUncertainty seen = ground_uncertainty(observations, camera, ground);
  Matrix6d covariance = Matrix6d::Zero();
  covariance(2, 2) = seen.height_variance;
  if (seen.planes > 0) {
    // Up turns by dw x up: the tilt about an axis is the normal's error along the other.
    const Eigen::Matrix3d T = skew(Eigen::Vector3d::UnitZ()) * T_robot_camera.rotation_matrix();
    covariance.bottomRightCorner<3, 3>() = T * seen.up_covariance * T.transpose();
  } else {
    covariance(3, 3) = covariance(4, 4) = alignment.sigma_up_rad * alignment.sigma_up_rad;
  }
  covariance(5, 5) = yaw_variance(observations, guess) + heading_variance(views, camera, T_robot_camera);
  return covariance;
}

}  // namespace rigproof
