// Effect on planes of a depth sensor's fixed, smooth error over its view (DepthNoise::inverse_depth_bias).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// Source of the depth scale: the device, or depth on the board, whose bias it then inherits.
enum class DepthScaleSource { kDevice, kBoard };

/// Covariance [1/m^2] of the error that it adds to all ground planes of a camera alike, one a camera: zero if no bias
/// is stated or no ground was seen; empty if that holds for every camera. The floor is assumed to fill the image below
/// its horizon, from the sensor's least range to the end implied by the planes' covariances.
std::vector<Eigen::Matrix3d> ground_plane_biases(const Observations& observations, DepthScaleSource scale);

/// One sigma of the resulting error of the height above ground, over that height, one a camera; 0 if no bias is stated.
std::vector<double> relative_height_biases(const Observations& observations);

/// Covariance [1/m^2] of the error that it adds to each board plane, zero if no bias is stated; empty if no camera
/// states one. The error depends on the place in the image; the part common to all views is in ground_plane_biases().
std::vector<Eigen::Matrix3d> board_plane_biases(const Observations& observations);

/// `of_each` and `more` together; either may be empty.
std::vector<Eigen::Matrix3d> sum_of(std::vector<Eigen::Matrix3d> of_each, const std::vector<Eigen::Matrix3d>& more);

}  // namespace rigproof
