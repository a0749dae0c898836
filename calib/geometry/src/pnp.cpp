#include "rigproof/calib/geometry/pnp.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ippe.h"

namespace rigproof {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A corner with what every iteration needs of it.
struct Corner {
  Vector3d point_board;
  Vector2d pixel;
  Eigen::Matrix2d information;
};

std::vector<Corner> prepare(const std::vector<CornerObservation>& observed, const Board& board) {
  std::vector<Corner> corners;
  corners.reserve(observed.size());
  for (const CornerObservation& corner : observed)
    corners.push_back({board.corner(corner.id), corner.pixel, corner.covariance_px2.inverse()});
  return corners;
}

/// Weighted normal equations of the reprojection error in the chart of transform_error().
struct ReprojectionSystem {
  bool valid = false;  ///< every corner projects
  double cost = std::numeric_limits<double>::infinity();
  double squared_px = 0.0;
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

ReprojectionSystem linearise(const Rigid3& pose, const std::vector<Corner>& corners, const Camera& camera) {
  ReprojectionSystem system;
  const Matrix3d R = pose.rotation_matrix();
  double cost = 0.0;
  for (const Corner& corner : corners) {
    const Vector3d turned = R * corner.point_board;
    Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J_point;
    if (!camera.project(turned + pose.translation, &pixel, &J_point)) return system;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> J;
    for (int row = 0; row < 2; ++row) {
      const Vector3d a = J_point.row(row);
      J.row(row) << a.transpose(), turned.cross(a).transpose();
    }
    const Vector2d error = pixel - corner.pixel;
    const Eigen::Matrix<double, 6, 2> weighted = J.transpose() * corner.information;
    system.squared_px += error.squaredNorm();
    cost += error.dot(corner.information * error);
    system.normal.noalias() += weighted.lazyProduct(J);
    system.gradient.noalias() += weighted.lazyProduct(error);
  }
  system.cost = cost;
  system.valid = std::isfinite(cost);
  return system;
}

struct RefinedPose {
  Rigid3 pose;
  ReprojectionSystem system;
};

// Gauss-Newton with Levenberg's damping; returns the start where nothing is better.
// @param rival a cost that is to be beaten: what clearly cannot is not refined to the end.
RefinedPose refine(const Rigid3& start, const std::vector<Corner>& corners, const Camera& camera,
                   double rival = std::numeric_limits<double>::infinity()) {
  // Metres and radians. Gauss-Newton gains a digit or more with every step: what is left after this one is rounding.
  constexpr double kLastStep = 1e-9;
  constexpr double kHopeless = 2.0, kLittle = 1e-3;
  RefinedPose best{start, linearise(start, corners, camera)};
  double damping = 1e-6;
  for (int iteration = 0; iteration < 50 && best.system.valid && damping < 1e8; ++iteration) {
    Matrix6d damped = best.system.normal;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = damped.ldlt().solve(-best.system.gradient);
    if (!step.allFinite()) break;
    const double promised = -step.dot(best.system.gradient);
    if (best.system.cost > kHopeless * rival && damping < 1e-3 && promised < kLittle * best.system.cost) break;
    const Rigid3 pose = apply_transform_error(best.pose, step);
    const ReprojectionSystem system = linearise(pose, corners, camera);
    const bool better = system.valid && system.cost < best.system.cost;
    if (better) best = {pose, system};
    damping = better ? std::max(0.1 * damping, 1e-12) : 10.0 * damping;
    if (step.norm() < kLastStep) break;
  }
  return best;
}

// Both of IPPE's poses from rays through the undistorted corners.
std::vector<Rigid3> starting_poses(const std::vector<CornerObservation>& corners, const Board& board,
                                   const Camera& camera) {
  std::vector<detection::PlaneRay> points;
  points.reserve(corners.size());
  for (const CornerObservation& corner : corners) {
    Vector3d ray;
    if (corner.id < 0 || corner.id >= board.corner_count() || !corner.pixel.allFinite()) return {};
    if (!camera.unproject(corner.pixel, &ray)) return {};
    points.push_back({board.corner(corner.id).head<2>(), ray.head<2>()});
  }
  return detection::ippe_poses(points);
}

// IPPE needs the four corners of a rectangle at least, not a row of them.
bool spans_a_plane(const std::vector<CornerObservation>& corners, const Board& board) {
  Vector3d mean = Vector3d::Zero();
  for (const CornerObservation& corner : corners) mean += board.corner(corner.id);
  mean /= static_cast<double>(corners.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const CornerObservation& corner : corners) {
    const Vector3d d = board.corner(corner.id) - mean;
    spread += d * d.transpose();
  }
  const double trace = spread(0, 0) + spread(1, 1);
  return spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(0, 1) > 1e-6 * trace * trace;
}

double rms_px(const ReprojectionSystem& system, std::size_t corners) {
  return std::sqrt(system.squared_px / static_cast<double>(corners));
}

// How much worse the other pose explains the corners. Where both starts slid into one minimum, the worse start is
// judged where IPPE put it.
double ambiguity(const RefinedPose& best, const RefinedPose& other, const std::vector<Rigid3>& starts,
                 const std::vector<Corner>& corners, const Camera& camera) {
  constexpr double kSamePoseRad = 0.01;
  const auto rms_of = [&](const ReprojectionSystem& system) {
    return system.valid ? rms_px(system, corners.size()) : std::numeric_limits<double>::infinity();
  };
  const auto rms_at = [&](const Rigid3& pose) { return rms_of(linearise(pose, corners, camera)); };
  const bool same = transform_error(other.pose, best.pose).tail<3>().norm() < kSamePoseRad;
  const double rms = same ? std::max(rms_at(starts[0]), rms_at(starts[1])) : rms_of(other.system);
  return rms / std::max(rms_px(best.system, corners.size()), 1e-12);
}

}  // namespace

std::optional<BoardPose> estimate_board_pose(const std::vector<CornerObservation>& observed, const Board& board,
                                             const Camera& camera) {
  if (observed.size() < 4 || !spans_a_plane(observed, board)) return std::nullopt;
  const std::vector<Rigid3> starts = starting_poses(observed, board, camera);
  if (starts.empty()) return std::nullopt;
  const std::vector<Corner> corners = prepare(observed, board);
  std::vector<RefinedPose> poses = {refine(starts[0], corners, camera)};
  for (std::size_t i = 1; i < starts.size(); ++i)
    poses.push_back(refine(starts[i], corners, camera, poses[0].system.cost));
  const std::size_t best = poses.size() > 1 && poses[1].system.cost < poses[0].system.cost ? 1 : 0;
  const RefinedPose& found = poses[best];
  if (!found.system.valid || !(found.pose.translation.z() > 0.0)) return std::nullopt;
  BoardPose result;
  result.T_camera_board = found.pose;
  result.covariance = found.system.normal.ldlt().solve(Matrix6d::Identity());
  if (!result.covariance.allFinite()) return std::nullopt;
  result.reprojection_rms_px = rms_px(found.system, corners.size());
  result.ambiguity_ratio = poses.size() < 2 ? std::numeric_limits<double>::infinity()
                                            : ambiguity(found, poses[1 - best], starts, corners, camera);
  return result;
}

}  // namespace rigproof
