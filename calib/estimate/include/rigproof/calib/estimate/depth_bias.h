// Effect on planes of a depth sensor's fixed, smooth error over its view (DepthNoise::inverse_depth_bias).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// Mean of 1/z over the points of a plane, by their weights [1/m]: its covariance tells how far off they are.
double mean_inverse_depth(const PlaneObservation& plane);

/// Derivative of a plane without an error of its depth camera by that error: depth too large by an offset [m], and a
/// turn of the depth camera against the colour camera about x and y of the latter [rad]. An offset bends a plane in
/// 1/z a little: this is the plane that touches it at the points' mean.
/// @param measured the plane with the error: 1/z = a . ray [1/m]
Eigen::Matrix3d plane_by_depth_offset(const Eigen::Vector3d& measured, double mean_inverse_depth);

/// Derivative of a plane without an error of its depth camera's image by that error: rays that are shifted along x and
/// y [tan], 1/z that grows along x and y [1/tan], a focal length that is too small (relative), and a turn about the
/// optical axis [rad].
/// @param measured the plane with the error: 1/z = a . ray [1/m]
Eigen::Matrix<double, 3, 6> plane_by_depth_shape(const Eigen::Vector3d& measured);

/// Covariance [1/m^2] of the error that it adds to all ground planes of a camera alike, one a camera: zero if no bias
/// is stated or no ground was seen; empty if that holds for every camera. The floor is assumed to fill the image below
/// its horizon, from the sensor's least range to the end implied by the planes' covariances.
std::vector<Eigen::Matrix3d> ground_plane_biases(const Observations& observations);

/// One sigma of the resulting error of the height above ground, over that height, one a camera; 0 if no bias is stated.
std::vector<double> relative_height_biases(const Observations& observations);

/// Covariance [1/m^2] of the error that it adds to each board plane, zero if no bias is stated; empty if no camera
/// states one. The error depends on the place in the image.
std::vector<Eigen::Matrix3d> board_plane_biases(const Observations& observations);

/// The same, so many times larger as boards of the camera are seen at the same place: as errors that are independent,
/// they leave as much in a mean of many as the one that they share.
std::vector<Eigen::Matrix3d> lasting_board_plane_biases(const Observations& observations);

/// `of_each` and `more` together; either may be empty.
std::vector<Eigen::Matrix3d> sum_of(std::vector<Eigen::Matrix3d> of_each, const std::vector<Eigen::Matrix3d>& more);

}  // namespace rigproof
