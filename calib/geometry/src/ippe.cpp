#include "ippe.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/core/rotation_between.h"

namespace rigproof::detection {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

// Moves the centroid to the origin and the mean distance to one, for a well-conditioned linear system.
struct Normalisation {
  Vector2d centre = Vector2d::Zero();
  double scale = 1.0;

  Normalisation(const std::vector<PlaneRay>& points, Vector2d PlaneRay::*member) {
    for (const PlaneRay& point : points) centre += point.*member;
    centre /= static_cast<double>(points.size());
    double distance = 0.0;
    for (const PlaneRay& point : points) distance += (point.*member - centre).norm();
    scale = static_cast<double>(points.size()) / distance;
  }
  Vector2d operator()(const Vector2d& p) const { return scale * (p - centre); }
};

// The homography's value and derivative at the centroid of the points: all that the rotation depends on.
struct FirstOrder {
  Vector2d ray;
  Matrix2d by_point;  ///< 1/m
};

// Direct linear transform with the last element one: the centroid is in front of the camera, so it is not zero.
std::optional<FirstOrder> first_order(const std::vector<PlaneRay>& points, const Vector2d& centre) {
  const Normalisation plane(points, &PlaneRay::point_m), image(points, &PlaneRay::ray);
  if (!std::isfinite(plane.scale) || !std::isfinite(image.scale)) return std::nullopt;
  Matrix8d normal = Matrix8d::Zero();
  Vector8d right = Vector8d::Zero();
  for (const PlaneRay& point : points) {
    const Vector2d p = plane(point.point_m), r = image(point.ray);
    Eigen::Matrix<double, 2, 8> rows;
    rows << p.x(), p.y(), 1.0, 0.0, 0.0, 0.0, -r.x() * p.x(), -r.x() * p.y(),  //
        0.0, 0.0, 0.0, p.x(), p.y(), 1.0, -r.y() * p.x(), -r.y() * p.y();
    normal.noalias() += rows.transpose() * rows;
    right.noalias() += rows.transpose() * r;
  }
  const Eigen::LDLT<Matrix8d> ldlt(normal);
  // Three of four points on one line, say.
  if (!(ldlt.vectorD().minCoeff() > 1e-12 * ldlt.vectorD().maxCoeff())) return std::nullopt;
  const Vector8d h = ldlt.solve(right);
  const Vector2d p = plane(centre);
  const double weight = h[6] * p.x() + h[7] * p.y() + 1.0;
  const Vector2d value(h[0] * p.x() + h[1] * p.y() + h[2], h[3] * p.x() + h[4] * p.y() + h[5]);
  const Vector2d mapped = value / weight;
  Matrix2d J;
  J << h[0] - mapped.x() * h[6], h[1] - mapped.x() * h[7], h[3] - mapped.y() * h[6], h[4] - mapped.y() * h[7];
  FirstOrder result{mapped / image.scale + image.centre, J * (plane.scale / (weight * image.scale))};
  if (!result.ray.allFinite() || !result.by_point.allFinite()) return std::nullopt;
  return result;
}

// Rotation that takes the optical axis to the ray.
Matrix3d axis_to_ray(const Vector2d& ray) {
  return rotation_between(Vector3d::UnitZ(), ray.homogeneous()).toRotationMatrix();
}

// With A = [I | -ray] R_ray, by_point = A R(:, 1..2) / depth: the upper left of R_ray^T R up to the depth, which its
// largest singular value is; the third row has length and sign to be a rotation's, but for a common sign.
bool rotations(const FirstOrder& h, Matrix3d* first, Matrix3d* second) {
  const Matrix3d R_ray = axis_to_ray(h.ray);
  const Matrix2d B = R_ray.topLeftCorner<2, 2>() - h.ray * R_ray.row(2).head<2>();
  const Matrix2d A = B.inverse() * h.by_point;
  const Matrix2d S = A * A.transpose();
  const double half_trace = 0.5 * S.trace();
  const double spread = std::hypot(0.5 * (S(0, 0) - S(1, 1)), S(0, 1));
  const double inverse_depth = std::sqrt(half_trace + spread);
  if (!(inverse_depth > 0.0) || !std::isfinite(inverse_depth)) return false;
  const Matrix2d R22 = A / inverse_depth;
  const Matrix2d rest = Matrix2d::Identity() - R22.transpose() * R22;
  Vector2d b(std::sqrt(std::max(0.0, rest(0, 0))), std::sqrt(std::max(0.0, rest(1, 1))));
  if (rest(0, 1) < 0.0) b.y() = -b.y();
  const auto complete = [&](double sign) {
    Matrix3d R;
    R.topLeftCorner<2, 2>() = R22;
    R.bottomLeftCorner<1, 2>() = sign * b.transpose();
    R.col(2) = R.col(0).cross(R.col(1));
    return Matrix3d(R_ray * R);
  };
  *first = complete(1.0);
  *second = complete(-1.0);
  return first->allFinite() && second->allFinite();
}

// t with (R p + t) along the rays: linear least squares.
Vector3d translation(const std::vector<PlaneRay>& points, const Matrix3d& R) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const PlaneRay& point : points) {
    const Vector3d turned = R.leftCols<2>() * point.point_m;
    Eigen::Matrix<double, 2, 3> rows;
    rows << 1.0, 0.0, -point.ray.x(), 0.0, 1.0, -point.ray.y();
    normal.noalias() += rows.transpose() * rows;
    right.noalias() -= rows.transpose() * (rows * turned);
  }
  return normal.ldlt().solve(right);
}

double squared_error(const std::vector<PlaneRay>& points, const Matrix3d& R, const Vector3d& t) {
  double sum = 0.0;
  for (const PlaneRay& point : points) {
    const Vector3d p = R.leftCols<2>() * point.point_m + t;
    sum += (p.head<2>() / p.z() - point.ray).squaredNorm();
  }
  return sum;
}

}  // namespace

std::vector<Rigid3> ippe_poses(const std::vector<PlaneRay>& points) {
  if (points.size() < 4) return {};
  Vector2d centre = Vector2d::Zero();
  for (const PlaneRay& point : points) centre += point.point_m / static_cast<double>(points.size());
  const std::optional<FirstOrder> h = first_order(points, centre);
  Matrix3d R[2];
  if (!h || !rotations(*h, &R[0], &R[1])) return {};
  std::vector<std::pair<double, Rigid3>> found;
  for (const Matrix3d& rotation : R) {
    const Vector3d t = translation(points, rotation);
    if (!t.allFinite() || !(t.z() > 0.0)) continue;
    found.emplace_back(squared_error(points, rotation, t), Rigid3(Eigen::Quaterniond(rotation), t));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Rigid3> poses;
  for (const auto& [error, pose] : found) poses.push_back(pose);
  return poses;
}

}  // namespace rigproof::detection
