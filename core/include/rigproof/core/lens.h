// The two lens distortions as templates, so that hand-written and automatic derivatives share one formula.
// Points are normalised: (x, y) = (X / Z, Y / Z).
#pragma once

#include <cmath>

namespace rigproof {

/// Brown-Conrady: radial k1 k2 k3 and tangential p1 p2 (Brown 1966; OpenCV's order k1 k2 p1 p2 k3).
/// xd = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
/// yd = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
template <typename T, typename K>
void distort_brown_conrady(const K* k, const T& x, const T& y, T* xd, T* yd) {
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (T(k[0]) + r2 * (T(k[1]) + r2 * T(k[4])));
  *xd = x * radial + T(2.0) * T(k[2]) * x * y + T(k[3]) * (r2 + T(2.0) * x * x);
  *yd = y * radial + T(k[2]) * (r2 + T(2.0) * y * y) + T(2.0) * T(k[3]) * x * y;
}

/// Kannala-Brandt: theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta = atan(r)
/// (Kannala and Brandt 2006, equation 6, in OpenCV's fisheye form).
template <typename T, typename K>
void distort_kannala_brandt(const K* k, const T& x, const T& y, T* xd, T* yd) {
  using std::atan;
  using std::sqrt;
  const T r2 = x * x + y * y;
  T scale;
  if (r2 < T(1e-12)) {
    // Taylor: theta / r = 1 - r^2 / 3, which keeps derivatives finite on the axis.
    scale = T(1.0) + (T(k[0]) - T(1.0 / 3.0)) * r2;
  } else {
    const T r = sqrt(r2);
    const T theta = atan(r);
    const T t2 = theta * theta;
    scale = theta * (T(1.0) + t2 * (T(k[0]) + t2 * (T(k[1]) + t2 * (T(k[2]) + t2 * T(k[3]))))) / r;
  }
  *xd = scale * x;
  *yd = scale * y;
}

}  // namespace rigproof
