// The two poses of a plane that explain an image of it about equally well.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof::detection {

/// Point of the plane z = 0 and the ray (x, y, 1) to it.
struct PlaneRay {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();
};

/// Infinitesimal plane-based pose estimation (Collins and Bartoli, IJCV 2014): the homography's value and first
/// derivative at the points' centroid leave two rotations; each translation follows by least squares.
/// @returns poses T_camera_plane in front of the camera, the one with the smaller reprojection error first; none where
/// the points are fewer than four or determine no homography.
std::vector<Rigid3> ippe_poses(const std::vector<PlaneRay>& points);

}  // namespace rigproof::detection
