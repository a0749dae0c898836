// Images of a lens that no model of ours follows as those of a camera without distortion.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/image.h"

namespace rigproof {

class Rectifier {
 public:
  /// @param camera without distortion, whose images are made
  /// @param d k1 k2 p1 p2 k3 k4 k5 k6 of the images that come in
  Rectifier(const Camera& camera, const std::vector<double>& d);

  // Of the camera's size; throws Error for others. What the lens does not show is black.
  Image8 color(const Image8& image) const;
  Image16 color(const Image16& image) const;
  /// Pixels as they are, for depth must not be mixed.
  Image16 depth(const Image16& image) const;

 private:
  template <typename Pixel>
  Image<Pixel> moved(const Image<Pixel>& image, int depth, int interpolation) const;

  cv::Mat x_, y_;  // where each pixel comes from
};

}  // namespace rigproof
