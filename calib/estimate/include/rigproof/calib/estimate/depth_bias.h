// What the fixed, smooth error of a depth sensor over its view (DepthNoise::inverse_depth_bias) does to planes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof {

/// Where the scale of depth comes from: as the device has it, or from depth on the board, whose bias it takes over.
enum class DepthScaleSource { kDevice, kBoard };

/// Covariance [1/m^2] of the error that it gives all ground planes of a camera alike, one a camera: zero where no bias
/// is stated or no ground was seen; empty if that is every camera. The floor is taken to fill the image below its
/// horizon, from the sensor's least range to where the planes' covariances say that it ends.
std::vector<Eigen::Matrix3d> ground_plane_biases(const Observations& observations, DepthScaleSource scale);

/// One sigma of the height above the ground that it leaves, over that height, one a camera; 0 where none is stated.
std::vector<double> relative_height_biases(const Observations& observations);

/// Covariance [1/m^2] of the error that it gives each of the board's planes, zero where no bias is stated; empty if no
/// camera states one. Views of other places in the image have other errors; what all of them share is in
/// ground_plane_biases().
std::vector<Eigen::Matrix3d> board_plane_biases(const Observations& observations);

/// `of_each` and `more` together; either may be empty.
std::vector<Eigen::Matrix3d> sum_of(std::vector<Eigen::Matrix3d> of_each, const std::vector<Eigen::Matrix3d>& more);

}  // namespace rigproof
