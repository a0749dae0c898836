#include "rigproof/core/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/lens.h"

namespace rigproof {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A point nearer to the focal plane than this has no meaningful projection [m].
constexpr double kMinDepth = 1e-9;

Vector2d distort(const Camera& camera, const Vector2d& n) {
  Vector2d d = n;
  if (camera.lens == Lens::kBrownConrady)
    distort_brown_conrady(camera.distortion.data(), n.x(), n.y(), &d.x(), &d.y());
  else if (camera.lens == Lens::kKannalaBrandt)
    distort_kannala_brandt(camera.distortion.data(), n.x(), n.y(), &d.x(), &d.y());
  return d;
}

Matrix2d brown_conrady_jacobian(const std::array<double, 5>& k, const Vector2d& n) {
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double slope = 2.0 * (k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]));  // d radial / d(r2) * 2
  const double cross = slope * x * y + 2.0 * k[2] * x + 2.0 * k[3] * y;
  Matrix2d J;
  J << radial + slope * x * x + 2.0 * k[2] * y + 6.0 * k[3] * x, cross, cross,
      radial + slope * y * y + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return J;
}

double kannala_brandt_angle(const std::array<double, 5>& k, double theta) {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double kannala_brandt_slope(const std::array<double, 5>& k, double theta) {
  const double t2 = theta * theta;
  return 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
}

Matrix2d kannala_brandt_jacobian(const std::array<double, 5>& k, const Vector2d& n) {
  const double r2 = n.squaredNorm();
  if (r2 < 1e-12) return Matrix2d::Identity();
  const double r = std::sqrt(r2), theta = std::atan(r);
  const double scale = kannala_brandt_angle(k, theta) / r;
  const double radial_slope = kannala_brandt_slope(k, theta) / (1.0 + r2);  // d theta_d / d r
  const Matrix2d outer = n * n.transpose() / r2;
  return scale * (Matrix2d::Identity() - outer) + radial_slope * outer;
}

Matrix2d distortion_jacobian(const Camera& camera, const Vector2d& n) {
  switch (camera.lens) {
    case Lens::kBrownConrady:
      return brown_conrady_jacobian(camera.distortion, n);
    case Lens::kKannalaBrandt:
      return kannala_brandt_jacobian(camera.distortion, n);
    case Lens::kPinhole:
      break;
  }
  return Matrix2d::Identity();
}

// Smallest positive root of 1 + c1 s + c2 s^2 + c3 s^3 + c4 s^4 for s up to `limit`, else `limit`.
double first_root(const std::array<double, 4>& c, double limit) {
  const auto value = [&](double s) { return 1.0 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3]))); };
  constexpr int kSteps = 256;
  double previous = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    double low = previous, high = limit * i / kSteps;
    previous = high;
    if (value(high) > 0.0) continue;
    for (int j = 0; j < 60; ++j) (value(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
    return low;
  }
  return limit;
}

// Sufficient and cheap: the negative terms alone cannot pull the polynomial of first_root() to zero by s.
bool surely_positive(const std::array<double, 4>& c, double s) {
  double value = 1.0, power = s;
  for (const double coefficient : c) {
    value += std::min(coefficient, 0.0) * power;
    power *= s;
  }
  return value > 0.0;
}

// Square of the normalised radius up to which the radial part of Brown-Conrady grows.
double brown_conrady_max_r2(const std::array<double, 5>& k) {
  constexpr double kLimit = 100.0;  // 84 degrees off the axis
  return first_root({3.0 * k[0], 5.0 * k[1], 7.0 * k[4], 0.0}, kLimit);
}

bool within_lens_field(const Camera& camera, const Vector2d& n) {
  const std::array<double, 5>& k = camera.distortion;
  const double r2 = n.squaredNorm();
  if (camera.lens == Lens::kBrownConrady)
    return surely_positive({3.0 * k[0], 5.0 * k[1], 7.0 * k[4], 0.0}, r2) || r2 <= brown_conrady_max_r2(k);
  if (camera.lens == Lens::kKannalaBrandt) {
    const double theta = std::atan(std::sqrt(r2));
    return surely_positive({3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]}, theta * theta) ||
           theta < camera.max_field_angle();
  }
  return true;
}

bool undistort(const Camera& camera, const Vector2d& d, Vector2d* n) {
  if (camera.lens == Lens::kPinhole) {
    *n = d;
    return true;
  }
  if (camera.lens == Lens::kKannalaBrandt) {
    const double target = d.norm();
    double theta = target;
    for (int i = 0; i < 50; ++i) {
      const double step =
          (kannala_brandt_angle(camera.distortion, theta) - target) / kannala_brandt_slope(camera.distortion, theta);
      theta -= step;
      if (!std::isfinite(theta)) return false;
      if (std::abs(step) < 1e-15) break;
    }
    if (theta < 0.0 || theta >= camera.max_field_angle()) return false;
    if (std::abs(kannala_brandt_angle(camera.distortion, theta) - target) > 1e-9) return false;
    *n = target < 1e-12 ? d : Vector2d(d * (std::tan(theta) / target));
    return true;
  }
  Vector2d estimate = d;
  for (int i = 0; i < 50; ++i) {
    const Vector2d step =
        brown_conrady_jacobian(camera.distortion, estimate).inverse() * (distort(camera, estimate) - d);
    estimate -= step;
    if (!estimate.allFinite()) return false;
    if (step.norm() < 1e-14) break;
  }
  if (!within_lens_field(camera, estimate)) return false;
  if ((distort(camera, estimate) - d).norm() > 1e-9) return false;
  *n = estimate;
  return true;
}

}  // namespace

int coefficient_count(Lens lens) {
  switch (lens) {
    case Lens::kBrownConrady:
      return 5;
    case Lens::kKannalaBrandt:
      return 4;
    case Lens::kPinhole:
      break;
  }
  return 0;
}

const char* lens_name(Lens lens) {
  switch (lens) {
    case Lens::kBrownConrady:
      return "brown_conrady";
    case Lens::kKannalaBrandt:
      return "kannala_brandt";
    case Lens::kPinhole:
      break;
  }
  return "pinhole";
}

Camera Camera::symmetric(int width_px, int height_px, double focal_px) {
  Camera camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = camera.fy_px = focal_px;
  camera.cx_px = symmetric_principal_point(width_px);
  camera.cy_px = symmetric_principal_point(height_px);
  return camera;
}

bool Camera::project(const Vector3d& p_camera, Vector2d* pixel, Eigen::Matrix<double, 2, 3>* J_pixel_point) const {
  if (!(p_camera.z() > kMinDepth)) return false;
  const Vector2d n = p_camera.head<2>() / p_camera.z();
  if (!std::isfinite(n.squaredNorm()) || !within_lens_field(*this, n)) return false;
  const Vector2d d = distort(*this, n);
  *pixel = Vector2d(fx_px * d.x() + cx_px, fy_px * d.y() + cy_px);
  if (J_pixel_point != nullptr) {
    Eigen::Matrix<double, 2, 3> J_normalised;
    J_normalised << 1.0, 0.0, -n.x(), 0.0, 1.0, -n.y();
    const Vector2d focal(fx_px, fy_px);
    *J_pixel_point = focal.asDiagonal() * distortion_jacobian(*this, n) * J_normalised / p_camera.z();
  }
  return true;
}

bool Camera::unproject(const Vector2d& pixel, Vector3d* ray) const {
  const Vector2d d((pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px);
  Vector2d n;
  if (!undistort(*this, d, &n)) return false;
  *ray = Vector3d(n.x(), n.y(), 1.0);
  return true;
}

bool Camera::contains(const Vector2d& pixel, double margin_px) const {
  return pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() <= width_px - 1 - margin_px &&
         pixel.y() <= height_px - 1 - margin_px;
}

Eigen::Matrix3d Camera::matrix() const {
  Eigen::Matrix3d K;
  K << fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0;
  return K;
}

double Camera::max_field_angle() const {
  const std::array<double, 5>& k = distortion;
  switch (lens) {
    case Lens::kBrownConrady:
      return std::atan(std::sqrt(brown_conrady_max_r2(k)));
    case Lens::kKannalaBrandt:
      return std::sqrt(first_root({3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]}, 0.25 * kPi * kPi));
    case Lens::kPinhole:
      break;
  }
  return 0.5 * kPi;
}

}  // namespace rigproof
