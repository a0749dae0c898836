// Point clouds as a depth camera's driver would publish them, and their PCD files.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/image.h"

namespace rigproof {

/// Turns depth images of one camera into points.
class CloudMaker {
 public:
  /// @param stride every how many pixels a point is taken, along both axes
  CloudMaker(const Camera& camera, int stride);

  /// Points with a depth, row by row, in the camera's frame [m].
  const std::vector<std::array<float, 3>>& points(const Image16& depth, double unit_m);

 private:
  struct Ray {
    int x, y;
    float ray_x, ray_y;  ///< at z = 1
  };
  std::vector<Ray> rays_;
  std::vector<std::array<float, 3>> points_;
};

/// A PCD file, version 0.7: x y z as 32-bit floats, binary, unorganised. All machines that this builds for are
/// little-endian, as the format expects.
std::string encode_pcd(const std::vector<std::array<float, 3>>& points);

}  // namespace rigproof
