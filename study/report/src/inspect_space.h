// Faces and lines in three dimensions, drawn from far to near.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "inspect_canvas.h"

namespace rigproof::inspect_detail {

/// A perspective view with z up, as large as fits a rectangle of the picture.
class SpaceView {
 public:
  /// @param towards_eye direction from the middle of `seen` to the eye, not along z
  /// @param seen what fits the rectangle [m], two points at least
  SpaceView(const Eigen::Vector3d& towards_eye, const std::vector<Eigen::Vector3d>& seen, const Eigen::Vector2d& corner,
            const Eigen::Vector2d& size);
  /// Pixel of the picture.
  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return origin_ + scale_ * on_plane(p); }
  /// From the eye, along its axis [m].
  double depth(const Eigen::Vector3d& p) const { return axes_.row(2).dot(p - eye_); }

 private:
  Eigen::Vector2d on_plane(const Eigen::Vector3d& p) const { return (axes_ * (p - eye_)).hnormalized(); }

  Eigen::Vector3d eye_;
  Eigen::Matrix3d axes_;  ///< rows: right, down, ahead
  double scale_ = 1.0;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
};

/// A flat polygon, filled, outlined or both; of two points a line.
struct Shape {
  std::vector<Eigen::Vector3d> points;
  Color fill{};
  double opacity = 0.0;  ///< 0: not filled
  Color edge{};
  double thickness = 0.0;  ///< [px]; 0: no outline
  bool dashed = false;
};

/// By the middles of the shapes, the farthest first: near ones cover it.
void draw_shapes(const std::vector<Shape>& shapes, const SpaceView& view, Canvas* canvas);

}  // namespace rigproof::inspect_detail
