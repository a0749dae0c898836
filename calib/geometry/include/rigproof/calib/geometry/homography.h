// Homography between the board's plane, in squares, and the image.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rigproof::detection {

struct PlanePoint {
  Eigen::Vector2d board = Eigen::Vector2d::Zero();  ///< in squares, (0, 0) = corner 0
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// pixel ~ H * (board, 1).
class Homography {
 public:
  /// Normalised direct linear transform (Hartley 1997), least squares. Absent with fewer than four points or
  /// degenerate ones.
  static std::optional<Homography> fit(const std::vector<PlanePoint>& points);

  /// False behind the camera's horizon.
  bool map(const Eigen::Vector2d& board, Eigen::Vector2d* pixel) const;
  bool unmap(const Eigen::Vector2d& pixel, Eigen::Vector2d* board) const;
  /// Derivative of the pixel by the board coordinates.
  Eigen::Matrix2d jacobian(const Eigen::Vector2d& board) const;
  const Eigen::Matrix3d& matrix() const { return H_; }
  const Eigen::Matrix3d& inverse() const { return H_inverse_; }

 private:
  Eigen::Matrix3d H_;
  Eigen::Matrix3d H_inverse_;
};

}  // namespace rigproof::detection
