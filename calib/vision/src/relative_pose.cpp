#include "rigproof/calib/vision/relative_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace rigproof::rivals {
namespace {

using Eigen::Vector3d;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kMinMatches = 12;
constexpr double kInlierSigmas = 3.0;

// Two directions perpendicular to a unit vector.
Eigen::Matrix<double, 3, 2> tangents(const Vector3d& t) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.unitOrthogonal();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

Rigid3 moved(const Rigid3& T, const Vector5d& step) {
  const Vector3d t = (T.translation + tangents(T.translation) * step.tail<2>()).normalized();
  return Rigid3(so3_exp(step.head<3>()) * T.rotation, t);
}

void refine(const std::vector<RayMatch>& matches, double sigma, Rigid3* T) {
  constexpr double kStep = 1e-6;
  for (int iteration = 0; iteration < 15; ++iteration) {
    Matrix5d H = Matrix5d::Zero();
    Vector5d g = Vector5d::Zero();
    std::vector<Rigid3> ahead, behind;
    for (Eigen::Index i = 0; i < 5; ++i) {
      Vector5d step = Vector5d::Zero();
      step(i) = kStep;
      ahead.push_back(moved(*T, step));
      behind.push_back(moved(*T, -step));
    }
    for (const RayMatch& match : matches) {
      const double e = sampson_error(*T, match);
      Vector5d J;
      for (std::size_t i = 0; i < 5; ++i)
        J(static_cast<Eigen::Index>(i)) =
            (sampson_error(ahead[i], match) - sampson_error(behind[i], match)) / (2.0 * kStep);
      const double weight = 1.0 / (1.0 + e * e / (sigma * sigma));
      H += weight * J * J.transpose();
      g += weight * e * J;
    }
    H.diagonal() *= 1.0 + 1e-9;
    const Vector5d step = H.ldlt().solve(-g);
    if (!step.allFinite() || step.norm() > 0.5) return;
    *T = moved(*T, step);
    if (step.norm() < 1e-10) return;
  }
}

// The one of the four motions of an essential matrix that puts points before both images.
Rigid3 motion_of(const cv::Mat& E, const std::vector<RayMatch>& matches) {
  Eigen::Matrix3d e;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) e(r, c) = E.at<double>(r, c);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(e, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d W;
  W << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  Rigid3 best;
  std::size_t best_count = 0;
  for (const Eigen::Matrix3d& middle : {W, Eigen::Matrix3d(W.transpose())}) {
    Eigen::Matrix3d R = svd.matrixU() * middle * svd.matrixV().transpose();
    if (R.determinant() < 0.0) R = -R;
    for (const double sign : {1.0, -1.0}) {
      const Rigid3 T_b_a(Eigen::Quaterniond(R), sign * svd.matrixU().col(2));
      const Rigid3 T_a_b = T_b_a.inverse();
      const auto count = static_cast<std::size_t>(std::count_if(
          matches.begin(), matches.end(), [&](const RayMatch& m) { return triangulate(T_a_b, m).has_value(); }));
      if (count <= best_count) continue;
      best_count = count;
      best = T_a_b;
    }
  }
  return best;
}

}  // namespace

double sampson_error(const Rigid3& T_a_b, const RayMatch& match) {
  const Eigen::Matrix3d R = T_a_b.rotation_matrix();
  // a . (t x R b) = 0
  const Vector3d line_a = T_a_b.translation.cross(R * match.b);
  const Vector3d line_b = R.transpose() * match.a.cross(T_a_b.translation);
  const double size = std::sqrt(line_a.head<2>().squaredNorm() + line_b.head<2>().squaredNorm());
  return match.a.dot(line_a) / std::max(size, 1e-12);
}

std::optional<Vector3d> triangulate(const Rigid3& T_a_b, const RayMatch& match) {
  const Rigid3 T_b_a = T_a_b.inverse();
  Eigen::Matrix<double, 3, 4> P;
  P << T_b_a.rotation_matrix(), T_b_a.translation;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.row(0) << -1.0, 0.0, match.a.x(), 0.0;
  A.row(1) << 0.0, -1.0, match.a.y(), 0.0;
  A.row(2) = match.b.x() * P.row(2) - P.row(0);
  A.row(3) = match.b.y() * P.row(2) - P.row(1);
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(A, Eigen::ComputeFullV);
  const Eigen::Vector4d X = svd.matrixV().col(3);
  if (!(std::abs(X(3)) > 1e-9 * X.head<3>().norm())) return std::nullopt;
  const Vector3d point = X.head<3>() / X(3);
  if (!(point.z() > 0.0) || !((T_b_a * point).z() > 0.0)) return std::nullopt;
  return point;
}

std::optional<RelativePose> estimate_relative_pose(const std::vector<RayMatch>& matches, double sigma) {
  if (matches.size() < kMinMatches) return std::nullopt;
  std::vector<cv::Point2d> a, b;
  for (const RayMatch& match : matches) {
    a.emplace_back(match.a.x(), match.a.y());
    b.emplace_back(match.b.x(), match.b.y());
  }
  cv::Mat E;
  try {
    E = cv::findEssentialMat(a, b, cv::Mat::eye(3, 3, CV_64F), cv::RANSAC, 0.9999, kInlierSigmas * sigma);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (E.rows != 3 || E.cols != 3) return std::nullopt;
  RelativePose pose;
  pose.T_a_b = motion_of(E, matches);
  if (!(pose.T_a_b.translation.norm() > 0.5)) return std::nullopt;
  for (int round = 0; round < 3; ++round) {
    pose.inliers.clear();
    for (const RayMatch& match : matches)
      if (std::abs(sampson_error(pose.T_a_b, match)) < kInlierSigmas * sigma && triangulate(pose.T_a_b, match))
        pose.inliers.push_back(match);
    if (pose.inliers.size() < kMinMatches) return std::nullopt;
    if (round < 2) refine(pose.inliers, sigma, &pose.T_a_b);
  }
  return pose;
}

}  // namespace rigproof::rivals
