#include "rigproof/calib/geometry/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace rigproof::detection {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Moves the centroid to the origin and the mean distance to sqrt(2), for a well-conditioned linear system.
Matrix3d normalisation(const std::vector<PlanePoint>& points, Vector2d PlanePoint::*member) {
  Vector2d centre = Vector2d::Zero();
  for (const PlanePoint& point : points) centre += point.*member;
  centre /= static_cast<double>(points.size());
  double distance = 0.0;
  for (const PlanePoint& point : points) distance += (point.*member - centre).norm();
  const double scale = std::sqrt(2.0) * static_cast<double>(points.size()) / distance;
  Matrix3d T;
  T << scale, 0.0, -scale * centre.x(), 0.0, scale, -scale * centre.y(), 0.0, 0.0, 1.0;
  return T;
}

}  // namespace

std::optional<Homography> Homography::fit(const std::vector<PlanePoint>& points) {
  if (points.size() < 4) return std::nullopt;
  const Matrix3d T_board = normalisation(points, &PlanePoint::board),
                 T_pixel = normalisation(points, &PlanePoint::pixel);
  if (!T_board.allFinite() || !T_pixel.allFinite()) return std::nullopt;
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PlanePoint& point : points) {
    const Vector3d b = T_board * point.board.homogeneous(), p = T_pixel * point.pixel.homogeneous();
    Eigen::Matrix<double, 2, 9> rows;
    rows << b.transpose(), Eigen::RowVector3d::Zero(), -p.x() * b.transpose(), Eigen::RowVector3d::Zero(),
        b.transpose(), -p.y() * b.transpose();
    normal.noalias() += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  // A second null direction: three of four points on one line.
  if (eigen.eigenvalues()(1) < 1e-9 * eigen.eigenvalues()(8)) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  Matrix3d normalised;
  normalised << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
  Homography result;
  result.H_ = T_pixel.inverse() * normalised * T_board;
  // Positive weight on the side of the points that were seen.
  if (result.H_.row(2).dot(points.front().board.homogeneous()) < 0.0) result.H_ = -result.H_;
  result.H_ /= result.H_.norm();
  result.H_inverse_ = result.H_.inverse();
  if (!result.H_.allFinite() || !result.H_inverse_.allFinite()) return std::nullopt;
  return result;
}

bool Homography::map(const Vector2d& board, Vector2d* pixel) const {
  const Vector3d p = H_ * board.homogeneous();
  if (!(p.z() > 0.0)) return false;
  *pixel = p.hnormalized();
  return pixel->allFinite();
}

bool Homography::unmap(const Vector2d& pixel, Vector2d* board) const {
  const Vector3d b = H_inverse_ * pixel.homogeneous();
  *board = b.hnormalized();
  return board->allFinite() && H_.row(2).dot(board->homogeneous()) > 0.0;
}

Matrix2d Homography::jacobian(const Vector2d& board) const {
  const Vector3d p = H_ * board.homogeneous();
  const Vector2d pixel = p.hnormalized();
  return (H_.topLeftCorner<2, 2>() - pixel * H_.row(2).head<2>()) / p.z();
}

}  // namespace rigproof::detection
