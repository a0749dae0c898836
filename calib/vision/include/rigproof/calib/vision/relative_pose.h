// The motion of a camera between two images, up to the length of the step, from matched rays.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof::rivals {

/// One point of the world in two images: rays with z = 1.
struct RayMatch {
  Eigen::Vector3d a, b;
};

struct RelativePose {
  Rigid3 T_a_b;                   ///< translation of length 1
  std::vector<RayMatch> inliers;  ///< in front of both images
};

/// Essential matrix by RANSAC (Nister's five points, OpenCV), then least squares of the Sampson error under Cauchy's
/// loss. Absent where too few agree, or where the points do not show which way the camera went.
/// @param sigma standard deviation of a match [1, as rays], about a pixel over the focal length
std::optional<RelativePose> estimate_relative_pose(const std::vector<RayMatch>& matches, double sigma);

/// A point in the frame of the first image from the motion, by DLT; absent behind either image.
std::optional<Eigen::Vector3d> triangulate(const Rigid3& T_a_b, const RayMatch& match);

/// Sampson distance of a match from the epipolar geometry of a motion [1, as rays].
double sampson_error(const Rigid3& T_a_b, const RayMatch& match);

}  // namespace rigproof::rivals
