// Intrinsics of a camera and its projection, compatible with OpenCV's pinhole and fisheye models.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace rigproof {

/// Which lens the five distortion coefficients belong to.
enum class Lens {
  kPinhole,        ///< no coefficient
  kBrownConrady,   ///< k1 k2 p1 p2 k3, as OpenCV's calibrateCamera
  kKannalaBrandt,  ///< k1 k2 k3 k4, as OpenCV's fisheye
};

/// Number of coefficients that the lens uses: 0, 5 or 4.
int coefficient_count(Lens lens);
/// "pinhole", "brown_conrady", "kannala_brandt".
const char* lens_name(Lens lens);

/// Intrinsics: pixel = (fx * xd + cx, fy * yd + cy) with (xd, yd) the distorted normalised point.
/// Pixel centres are integers, the top-left one is (0, 0).
struct Camera {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  Lens lens = Lens::kPinhole;
  std::array<double, 5> distortion{};  ///< in OpenCV's order, unused ones zero

  /// Pinhole with square pixels and a centred principal point.
  static Camera symmetric(int width_px, int height_px, double focal_px);

  /// Projects a point in camera coordinates [m] to a pixel. Returns false, and leaves the outputs alone, when the
  /// point is not in front of the camera or beyond the field in which the lens model is one-to-one. Points that
  /// project outside of the image are valid: see contains().
  /// @param J_pixel_point 2x3 derivative of the pixel by the point, may be null.
  bool project(const Eigen::Vector3d& p_camera, Eigen::Vector2d* pixel,
               Eigen::Matrix<double, 2, 3>* J_pixel_point = nullptr) const;

  /// Ray through a pixel in camera coordinates, normalised to z = 1. Returns false where the lens has no such ray
  /// (beyond the model's field, or 90 degrees off the axis and more).
  bool unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* ray) const;

  /// True if the pixel lies inside the image, at least margin_px away from the outermost pixel centres.
  bool contains(const Eigen::Vector2d& pixel, double margin_px = 0.0) const;

  Eigen::Matrix3d matrix() const;
  /// Half of the angle, radians, from the axis within which the lens model is one-to-one (pinhole: pi/2).
  double max_field_angle() const;
};

}  // namespace rigproof
