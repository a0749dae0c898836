#include "rigproof/calib/pnp.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace rigproof {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Weighted normal equations of the reprojection error in the chart of transform_error().
struct ReprojectionSystem {
  bool valid = false;  ///< every corner projects
  double cost = std::numeric_limits<double>::infinity();
  double squared_px = 0.0;
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

ReprojectionSystem linearise(const Rigid3& pose, const std::vector<CornerObservation>& corners, const Board& board,
                             const Camera& camera) {
  ReprojectionSystem system;
  double cost = 0.0;
  for (const CornerObservation& corner : corners) {
    const Vector3d turned = pose.rotation * board.corner(corner.id);
    Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J_point;
    if (!camera.project(turned + pose.translation, &pixel, &J_point)) return system;
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(turned);
    const Vector2d error = pixel - corner.pixel;
    const Eigen::Matrix2d weight = corner.covariance_px2.inverse();
    system.squared_px += error.squaredNorm();
    cost += error.dot(weight * error);
    system.normal.noalias() += J.transpose() * weight * J;
    system.gradient.noalias() += J.transpose() * weight * error;
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
RefinedPose refine(const Rigid3& start, const std::vector<CornerObservation>& corners, const Board& board,
                   const Camera& camera) {
  RefinedPose best{start, linearise(start, corners, board, camera)};
  double damping = 1e-6;
  for (int iteration = 0; iteration < 50 && best.system.valid && damping < 1e8; ++iteration) {
    Matrix6d damped = best.system.normal;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = damped.ldlt().solve(-best.system.gradient);
    if (!step.allFinite()) break;
    const Rigid3 pose = apply_transform_error(best.pose, step);
    const ReprojectionSystem system = linearise(pose, corners, board, camera);
    const bool better = system.valid && system.cost < best.system.cost;
    if (better) best = {pose, system};
    damping = better ? std::max(0.1 * damping, 1e-12) : 10.0 * damping;
    if (step.norm() < 1e-12) break;
  }
  return best;
}

// Both of IPPE's poses from rays through the undistorted corners.
std::vector<Rigid3> ippe_poses(const std::vector<CornerObservation>& corners, const Board& board,
                               const Camera& camera) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const CornerObservation& corner : corners) {
    Vector3d ray;
    if (corner.id < 0 || corner.id >= board.corner_count() || !corner.pixel.allFinite()) return {};
    if (!camera.unproject(corner.pixel, &ray)) return {};
    const Vector3d p = board.corner(corner.id);
    points.emplace_back(p.x(), p.y(), 0.0);
    rays.emplace_back(ray.x(), ray.y());
  }
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(points, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {};  // degenerate corners
  }
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto vector = [](const cv::Mat& m) { return Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2)); };
    const Vector3d phi = vector(rotations[i]), t = vector(translations[i]);
    if (phi.allFinite() && t.allFinite() && t.z() > 0.0) poses.emplace_back(so3_exp(phi), t);
  }
  return poses;
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
                 const std::vector<CornerObservation>& corners, const Board& board, const Camera& camera) {
  constexpr double kSamePoseRad = 0.01;
  const auto rms_at = [&](const Rigid3& pose) {
    const ReprojectionSystem system = linearise(pose, corners, board, camera);
    return system.valid ? rms_px(system, corners.size()) : std::numeric_limits<double>::infinity();
  };
  const bool same = transform_error(other.pose, best.pose).tail<3>().norm() < kSamePoseRad;
  const double rms = same ? std::max(rms_at(starts[0]), rms_at(starts[1])) : rms_at(other.pose);
  return rms / std::max(rms_px(best.system, corners.size()), 1e-12);
}

}  // namespace

std::optional<BoardPose> estimate_board_pose(const std::vector<CornerObservation>& corners, const Board& board,
                                             const Camera& camera) {
  if (corners.size() < 4 || !spans_a_plane(corners, board)) return std::nullopt;
  const std::vector<Rigid3> starts = ippe_poses(corners, board, camera);
  std::vector<RefinedPose> poses;
  for (const Rigid3& start : starts) poses.push_back(refine(start, corners, board, camera));
  if (poses.empty()) return std::nullopt;
  const std::size_t best = poses.size() > 1 && poses[1].system.cost < poses[0].system.cost ? 1 : 0;
  const RefinedPose& found = poses[best];
  if (!found.system.valid || !(found.pose.translation.z() > 0.0)) return std::nullopt;
  BoardPose result;
  result.T_camera_board = found.pose;
  result.covariance = found.system.normal.ldlt().solve(Matrix6d::Identity());
  if (!result.covariance.allFinite()) return std::nullopt;
  result.reprojection_rms_px = rms_px(found.system, corners.size());
  result.ambiguity_ratio = poses.size() < 2 ? std::numeric_limits<double>::infinity()
                                            : ambiguity(found, poses[1 - best], starts, corners, board, camera);
  return result;
}

}  // namespace rigproof
