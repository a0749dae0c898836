#include "lens_map.h"

#include <algorithm>
#include <limits>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct CubicWeights {
  double w[4];
};

// Cubic through four nodes, at fraction t between the second and the third (Lagrange): exact for cubics.
CubicWeights lagrange_cubic(double t) {
  return {{-t * (t - 1.0) * (t - 2.0) / 6.0, 0.5 * (t + 1.0) * (t - 1.0) * (t - 2.0), -0.5 * (t + 1.0) * t * (t - 2.0),
           (t + 1.0) * t * (t - 1.0) / 6.0}};
}

void require_field(const Camera& camera) {
  const double right = camera.width_px - 1, bottom = camera.height_px - 1;
  const Eigen::Vector2d middles[] = {
      {0.0, 0.5 * bottom}, {right, 0.5 * bottom}, {0.5 * right, 0.0}, {0.5 * right, bottom}};
  for (const Eigen::Vector2d& pixel : middles) {
    Eigen::Vector3d ray;
    if (!camera.unproject(pixel, &ray) || ray.head<2>().norm() > LensMap::kMaxTangent)
      throw Error("camera of " + std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) +
                  " px with a " + lens_name(camera.lens) +
                  " lens looks more than 75 degrees away from its axis at pixel (" +
                  std::to_string(static_cast<int>(pixel.x())) + ", " + std::to_string(static_cast<int>(pixel.y())) +
                  "); a field of up to 150 degrees can be rendered: raise the focal length or crop the image");
  }
}

}  // namespace

LensMap::LensMap(const Camera& camera, const std::optional<LensResidual>& field) {
  require_field(camera);
  columns_ = (camera.width_px + 2 * kBorder) / kCell + 4;
  rows_ = (camera.height_px + 2 * kBorder) / kCell + 4;
  x_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kNan);
  y_ = x_;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      Eigen::Vector3d ray;
      if (!unproject(camera, field, {node_x(i), node_x(j)}, &ray) || ray.head<2>().norm() > kMaxTangent) continue;
      const std::size_t node =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
      x_[node] = ray.x();
      y_[node] = ray.y();
    }
  }
}

void LensMap::rays_of_row(double row, double first, double step, int count, double* xs, double* ys) const {
  const auto columns = static_cast<std::size_t>(columns_);
  line_x_.resize(columns);
  line_y_.resize(columns);
  const double v = (row + kBorder) / kCell;
  const int j = std::clamp(static_cast<int>(v), 0, rows_ - 4);
  const CubicWeights across = lagrange_cubic(v - j);
  const std::size_t base = static_cast<std::size_t>(j) * columns;
  for (std::size_t i = 0; i < columns; ++i) {
    line_x_[i] = line_y_[i] = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      line_x_[i] += across.w[k] * x_[base + k * columns + i];
      line_y_[i] += across.w[k] * y_[base + k * columns + i];
    }
  }
  for (int n = 0; n < count; ++n) {
    const double u = (first + n * step + kBorder) / kCell;
    const int i = std::clamp(static_cast<int>(u), 0, columns_ - 4);
    const CubicWeights along = lagrange_cubic(u - i);
    const double *lx = line_x_.data() + i, *ly = line_y_.data() + i;
    xs[n] = along.w[0] * lx[0] + along.w[1] * lx[1] + along.w[2] * lx[2] + along.w[3] * lx[3];
    ys[n] = along.w[0] * ly[0] + along.w[1] * ly[1] + along.w[2] * ly[2] + along.w[3] * ly[3];
  }
}

}  // namespace rigproof
