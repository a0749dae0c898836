#include "rigproof/generator/point_cloud.h"

#include "rigproof/core/error.h"

namespace rigproof {

CloudMaker::CloudMaker(const Camera& camera, int stride, const std::optional<Rigid3>& T_cloud_camera) {
  if (T_cloud_camera) {
    rotation_ = T_cloud_camera->rotation_matrix().cast<float>();
    offset_ = T_cloud_camera->translation.cast<float>();
  }
  is_moved_ = T_cloud_camera.has_value();
  if (stride < 1) throw Error("stride of a point cloud: " + std::to_string(stride) + "; must be 1 or more");
  for (int y = 0; y < camera.height_px; y += stride) {
    for (int x = 0; x < camera.width_px; x += stride) {
      Eigen::Vector3d ray;
      if (!camera.unproject(Eigen::Vector2d(x, y), &ray)) continue;
      rays_.push_back({x, y, static_cast<float>(ray.x()), static_cast<float>(ray.y())});
    }
  }
  points_.reserve(rays_.size());
}

const std::vector<std::array<float, 3>>& CloudMaker::points(const Image16& depth, double unit_m) {
  points_.clear();
  for (const Ray& ray : rays_) {
    const std::uint16_t count = depth.at(ray.x, ray.y);
    if (count == 0) continue;
    const float z = static_cast<float>(count * unit_m);
    points_.push_back({ray.ray_x * z, ray.ray_y * z, z});
    if (!is_moved_) continue;
    Eigen::Map<Eigen::Vector3f> point(points_.back().data());
    point = (rotation_ * point + offset_).eval();
  }
  return points_;
}

}  // namespace rigproof
