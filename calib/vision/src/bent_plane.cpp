#include "bent_plane.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

namespace rigproof::detection {
namespace {

constexpr int kTerms = 6;

using Eigen::Vector2d;

Eigen::Matrix<double, 1, kTerms> terms(const Vector2d& b) {
  return (Eigen::Matrix<double, 1, kTerms>() << 1.0, b.x(), b.y(), b.x() * b.x(), b.x() * b.y(), b.y() * b.y())
      .finished();
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

std::optional<BentPlane> BentPlane::fit(const std::vector<PlanePoint>& points) {
  const auto n = static_cast<Eigen::Index>(points.size());
  if (2 * n < kUnknowns + kTerms) return std::nullopt;
  const std::optional<Homography> H = Homography::fit(points);
  if (!H) return std::nullopt;
  Eigen::Matrix<double, Eigen::Dynamic, kTerms> A(n, kTerms);
  Eigen::Matrix<double, Eigen::Dynamic, 2> off(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [place, pixel] = points[static_cast<std::size_t>(i)];
    Vector2d expected = pixel;
    H->map(place, &expected);
    A.row(i) = terms(place);
    off.row(i) = (pixel - expected).transpose();
  }
  return BentPlane(*H, A.colPivHouseholderQr().solve(off));
}

bool BentPlane::map(const Vector2d& place, Vector2d* pixel) const {
  if (!H_.map(place, pixel)) return false;
  *pixel += (terms(place) * bends_).transpose();
  return true;
}

std::optional<LocalPlane> BentPlane::near(const Vector2d& place) const {
  constexpr double kStep = 0.5;
  const auto at = [&](double x, double y, Vector2d* pixel) { return map(place + kStep * Vector2d(x, y), pixel); };
  Vector2d middle, right, left, below, above, diagonal;
  if (!at(0, 0, &middle) || !at(1, 0, &right) || !at(-1, 0, &left) || !at(0, 1, &below) || !at(0, -1, &above) ||
      !at(1, 1, &diagonal))
    return std::nullopt;
  constexpr double kStep2 = kStep * kStep;
  LocalPlane local;
  local.by_place.col(0) = (right - left) / (2.0 * kStep);
  local.by_place.col(1) = (below - above) / (2.0 * kStep);
  local.by_xx = (right + left - 2.0 * middle) / kStep2;
  local.by_yy = (below + above - 2.0 * middle) / kStep2;
  local.by_xy = (diagonal - right - below + middle) / kStep2;
  return local;
}

Vector2d LocalPlane::place(const Vector2d& pixel) const {
  const Eigen::Matrix2d inverse = by_place.inverse();
  Vector2d at = inverse * pixel;
  for (int round = 0; round < 2; ++round)
    at = inverse * (pixel - 0.5 * at.x() * at.x() * by_xx - at.x() * at.y() * by_xy - 0.5 * at.y() * at.y() * by_yy);
  return at;
}

Vector2d LocalPlane::curvature() const {
  const auto along = [](const Vector2d& first, const Vector2d& second) {
    return cross(first, second) / std::pow(first.norm(), 3);
  };
  return {along(by_place.col(0), by_xx), along(by_place.col(1), by_yy)};
}

}  // namespace rigproof::detection
