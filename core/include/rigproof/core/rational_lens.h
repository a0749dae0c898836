// OpenCV's rational lens as one of ours.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/camera.h"

namespace rigproof {

struct RationalFit {
  bool is_met = false;  ///< false: the camera has no distortion, and images are to be rectified
  std::string note;     ///< how near, in a sentence
};

/// Sets lens and coefficients of a camera, whose matrix and size are given, to those that come nearest to k1 k2 p1 p2
/// k3 k4 k5 k6 over the image, if one comes within a quarter of a pixel. Throws CameraInfoError for what bends the
/// image back into itself, and for coefficients beyond the eighth that are not zero (thin prism).
RationalFit fit_rational_lens(const std::vector<double>& d, Camera* camera);

/// Where the lens moves a ray, both at z = 1 (OpenCV's calibrateCamera).
Eigen::Vector2d rational_distorted(const std::vector<double>& d, const Eigen::Vector2d& ray);

}  // namespace rigproof
