// OpenCV's rational lens as one of ours.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/camera.h"

namespace rigproof {

/// Sets lens and coefficients of a camera, whose matrix and size are given, to those that come nearest to k1 k2 p1 p2
/// k3 k4 k5 k6 over the image. Returns a sentence on how near. Throws Error if no lens comes within a quarter of a
/// pixel, or for coefficients beyond the eighth that are not zero (thin prism).
std::string fit_rational_lens(const std::vector<double>& d, Camera* camera);

}  // namespace rigproof
