#include "inspect_space.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigproof::inspect_detail {
namespace {

void draw_dashed(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Shape& shape, Canvas* canvas) {
  constexpr double kDash = 5.0, kGap = 4.0;
  const double length = (to - from).norm();
  for (double at = 0.0; at < length; at += kDash + kGap)
    canvas->line(from + at / length * (to - from), from + std::min(1.0, (at + kDash) / length) * (to - from),
                 shape.edge, shape.thickness);
}

void draw_shape(const Shape& shape, const SpaceView& view, Canvas* canvas) {
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector3d& p : shape.points) points.push_back(view(p));
  if (shape.opacity > 0.0) canvas->polygon(points, shape.fill, shape.opacity);
  if (!(shape.thickness > 0.0)) return;
  if (!shape.dashed) return canvas->polyline(points, shape.edge, shape.thickness, points.size() > 2);
  for (std::size_t i = points.size() > 2 ? 0 : 1; i < points.size(); ++i)
    draw_dashed(points[i], points[(i + 1) % points.size()], shape, canvas);
}

}  // namespace

SpaceView::SpaceView(const Eigen::Vector3d& towards_eye, const std::vector<Eigen::Vector3d>& seen,
                     const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  constexpr double kFar = 2.2;  // of the diagonal: parallels hardly meet, near is still larger
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : seen) box.extend(p);
  const Eigen::Vector3d ahead = -towards_eye.normalized();
  eye_ = box.center() - kFar * box.diagonal().norm() * ahead;
  axes_.row(2) = ahead;
  axes_.row(0) = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
  axes_.row(1) = ahead.cross(axes_.row(0).transpose());
  Eigen::AlignedBox2d plane;
  for (const Eigen::Vector3d& p : seen) plane.extend(on_plane(p));
  scale_ = (size.array() / plane.sizes().array()).minCoeff();
  origin_ = corner + 0.5 * size - scale_ * plane.center();
}

void draw_shapes(const std::vector<Shape>& shapes, const SpaceView& view, Canvas* canvas) {
  std::vector<double> depths;
  for (const Shape& shape : shapes) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : shape.points) middle += p / static_cast<double>(shape.points.size());
    depths.push_back(view.depth(middle));
  }
  std::vector<std::size_t> order(shapes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depths[a] > depths[b]; });
  for (const std::size_t i : order) draw_shape(shapes[i], view, canvas);
}

}  // namespace rigproof::inspect_detail
