#include "rigproof/calib/vision/reference_cloud_plane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rigproof::rivals {
namespace {

constexpr double kThreshold_m = 1e-4;
constexpr int kMaxIterations = 1000;
constexpr double kConfidence = 0.99;

std::optional<CloudPlane> plane_through(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double size = normal.norm();
  if (!(size > 1e-9)) return std::nullopt;
  return CloudPlane{normal / size, -normal.dot(a) / size};
}

std::size_t count_inliers(const CloudPlane& plane, const std::vector<Eigen::Vector3f>& points) {
  const Eigen::Vector3f normal = plane.normal.cast<float>();
  const auto d = static_cast<float>(plane.d);
  const auto threshold = static_cast<float>(kThreshold_m);
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3f& p) {
    return std::abs(normal.dot(p) + d) <= threshold;
  }));
}

}  // namespace

std::optional<CloudPlane> largest_plane(const std::vector<Eigen::Vector3f>& points, RandomStream random) {
  if (points.size() < 3) return std::nullopt;
  const auto size = static_cast<std::uint32_t>(points.size());
  const auto draw = [&]() -> Eigen::Vector3d { return points[random.below(size)].cast<double>(); };
  std::optional<CloudPlane> best;
  std::size_t best_count = 0;
  double wanted = kMaxIterations;
  for (int i = 0; i < kMaxIterations && i < wanted; ++i) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw();
    const std::optional<CloudPlane> plane = plane_through(a, b, c);
    if (!plane) continue;
    const std::size_t count = count_inliers(*plane, points);
    if (count <= best_count) continue;
    best = plane;
    best_count = count;
    const double share = static_cast<double>(count) / static_cast<double>(points.size());
    wanted = std::log(1.0 - kConfidence) / std::log1p(-std::min(0.999999, share * share * share));
  }
  return best;
}

}  // namespace rigproof::rivals
