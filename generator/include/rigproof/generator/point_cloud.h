// Point clouds as a depth camera's driver would publish them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/image.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Turns depth images of one camera into points.
class CloudMaker {
 public:
  /// @param stride every how many pixels a point is taken, along both axes
  /// @param T_cloud_camera where the points go; without it they stay in the camera's frame
  CloudMaker(const Camera& camera, int stride, const std::optional<Rigid3>& T_cloud_camera = std::nullopt);

  /// Points with a depth, row by row, in the cloud's frame [m].
  const std::vector<std::array<float, 3>>& points(const Image16& depth, double unit_m);

 private:
  struct Ray {
    int x, y;
    float ray_x, ray_y;  ///< at z = 1
  };
  bool is_moved_ = false;
  Eigen::Matrix3f rotation_ = Eigen::Matrix3f::Identity();
  Eigen::Vector3f offset_ = Eigen::Vector3f::Zero();
  std::vector<Ray> rays_;
  std::vector<std::array<float, 3>> points_;
};

}  // namespace rigproof
