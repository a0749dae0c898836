// Random rotations, transforms and cameras for property tests; every test names its own stream.
#pragma once

#include "rigproof/core/camera.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/random.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

inline Eigen::Vector3d random_vector(RandomStream& random, double bound) {
  return {random.uniform(-bound, bound), random.uniform(-bound, bound), random.uniform(-bound, bound)};
}

/// Rotation vector with a uniform direction and an angle uniform in [0, max_angle_rad].
inline Eigen::Vector3d random_rotation_vector(RandomStream& random, double max_angle_rad) {
  const Eigen::Vector3d direction = draw_vector<3>([&random] { return random.normal(); });
  return direction.normalized() * random.uniform(0.0, max_angle_rad);
}

inline Rigid3 random_transform(RandomStream& random, double bound_m = 3.0, double max_angle_rad = 3.1) {
  const Eigen::Vector3d t = random_vector(random, bound_m);
  return Rigid3(so3_exp(random_rotation_vector(random, max_angle_rad)), t);
}

/// A realistic 1280x720 camera of the lens: off-centre, fx != fy, distortion as calibrations give it. No wider than
/// what the largest distortion drawn still maps one-to-one up to the image's corners.
inline Camera random_camera(RandomStream& random, Lens lens) {
  Camera camera = Camera::symmetric(1280, 720, random.uniform(800.0, 1100.0));
  camera.fy_px = camera.fx_px * random.uniform(0.98, 1.02);
  camera.cx_px += random.uniform(-30.0, 30.0);
  camera.cy_px += random.uniform(-30.0, 30.0);
  camera.lens = lens;
  const auto draw = [&random](double bound) { return random.uniform(-bound, bound); };
  if (lens == Lens::kBrownConrady) camera.distortion = {draw(0.1), draw(0.05), draw(0.002), draw(0.002), draw(0.02)};
  if (lens == Lens::kKannalaBrandt) camera.distortion = {draw(0.03), draw(0.01), draw(0.005), draw(0.002), 0.0};
  return camera;
}

}  // namespace rigproof
