#include "board_depth.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/median.h"

namespace rigproof::detection {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Depth sensors mix foreground and background near edges: stay this far inside the squares, and outside of the
// board's border [squares].
constexpr double kInside = 0.25, kOutside = 1.5;
constexpr std::size_t kMinPoints = 50;

/// One equation ray . a = 1 / z.
struct Row {
  Vector3d ray;
  double inverse_depth;
  double weight;  ///< 1 / sigma^2
};

std::vector<Row> rows_of(const DepthPoints& points, const DepthNoise& noise) {
  std::vector<Row> rows;
  rows.reserve(points.points.size());
  for (const Eigen::Vector3f& point : points.points) {
    const Vector3d p = point.cast<double>();
    const double sigma = noise.inverse_depth_sigma(p.z());
    rows.push_back({p / p.z(), 1.0 / p.z(), 1.0 / (sigma * sigma)});
  }
  return rows;
}

double standardised(const Row& row, const Vector3d& a) {
  return (row.ray.dot(a) - row.inverse_depth) * std::sqrt(row.weight);
}

struct Fit {
  Vector3d a = Vector3d::Zero();
  Matrix3d normal = Matrix3d::Zero();
  int used = 0;
  double squares = 0.0;  ///< of standardised residuals
};

// Least squares over the rows whose residual at `a` stays below the limit.
Fit fit_within(const std::vector<Row>& rows, const Vector3d& a, double limit) {
  Fit fit;
  Vector3d right = Vector3d::Zero();
  std::vector<const Row*> used;
  for (const Row& row : rows) {
    if (std::abs(standardised(row, a)) > limit) continue;
    fit.normal += row.weight * row.ray * row.ray.transpose();
    right += row.weight * row.inverse_depth * row.ray;
    used.push_back(&row);
  }
  fit.a = fit.normal.ldlt().solve(right);
  fit.used = static_cast<int>(used.size());
  for (const Row* row : used) fit.squares += standardised(*row, fit.a) * standardised(*row, fit.a);
  return fit;
}

// {p : a . p = 1} of the board's pose.
Vector3d plane_of(const Rigid3& T_camera_board) {
  const Vector3d n = T_camera_board.rotation * Vector3d::UnitZ();
  return n / n.dot(T_camera_board.translation);
}

DepthPoints without_points(const DepthPoints& points) {
  DepthPoints result = points;
  result.points.clear();
  return result;
}

}  // namespace

SplitPoints split_at_board(const DepthPoints& points, const Board& board, const Rigid3& T_camera_board) {
  SplitPoints split;
  split.on_board = split.elsewhere = without_points(points);
  const Vector3d plane = plane_of(T_camera_board);
  const Rigid3 T_board_camera = T_camera_board.inverse();
  const double s = board.square_m, overhang = overhang_m(board) / s, before = first_corner_m(board) / s + overhang;
  for (const Eigen::Vector3f& point : points.points) {
    const Vector3d p = point.cast<double>();
    const double along = plane.dot(p);  // > 0: the ray meets the board's plane in front of the camera
    if (!(along > 0.0)) {
      split.elsewhere.points.push_back(point);
      continue;
    }
    const Vector3d b =
        T_board_camera * Vector3d(p / along) / s + Vector3d(before, before, 0.0);  // squares, from the outline
    const double depth =
        std::min({b.x(), b.y(), board.squares_x + 2.0 * overhang - b.x(), board.squares_y + 2.0 * overhang - b.y()});
    if (depth > kInside) split.on_board.points.push_back(point);
    if (depth < -kOutside) split.elsewhere.points.push_back(point);
  }
  return split;
}

std::optional<PlaneObservation> fit_board_plane(const DepthPoints& points, const DepthNoise& noise,
                                                const Rigid3& T_camera_board) {
  if (points.points.size() < kMinPoints) return std::nullopt;
  const std::vector<Row> rows = rows_of(points, noise);
  const Vector3d expected = plane_of(T_camera_board);
  Vector3d a = expected;
  Fit fit;
  for (int round = 0; round < 5; ++round) {
    std::vector<double> sizes;
    sizes.reserve(rows.size());
    for (const Row& row : rows) sizes.push_back(std::abs(standardised(row, a)));
    // 1.4826 times the median of sizes is the deviation of a normal distribution.
    const double limit = 3.0 * 1.4826 * std::max(median(std::move(sizes)), 0.1);
    fit = fit_within(rows, a, limit);
    if (fit.used < static_cast<int>(kMinPoints) || !fit.a.allFinite()) return std::nullopt;
    a = fit.a;
  }
  PlaneObservation plane;
  plane.inverse_depth_plane = a;
  plane.inlier_points = fit.used;
  plane.effective_points = fit.used / points.points_per_measurement;
  plane.residual_rms = std::sqrt(fit.squares / fit.used);
  // Where the sensor is noisier than its law says, the residual tells.
  const double inflation = std::max(1.0, plane.residual_rms * plane.residual_rms);
  plane.covariance_per_m2 = inflation * points.points_per_measurement * fit.normal.ldlt().solve(Matrix3d::Identity());
  if (!plane.covariance_per_m2.allFinite()) return std::nullopt;
  return plane;
}

}  // namespace rigproof::detection
