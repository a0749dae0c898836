#include "comparison.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace rigproof::moved {
namespace {

constexpr double kLever_m = 0.3;  // a radian weighs as much as it moves a camera at this distance

// The same knowledge with the rig moved by D^-1 as one body.
KnownPoses moved_back(const KnownPoses& knowledge, const Rigid3& D) {
  KnownPoses result = knowledge;
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(knowledge.covariance.rows(), knowledge.covariance.cols());
  for (Eigen::Index i = 0; i < turn.rows(); i += 3) turn.block<3, 3>(i, i) = D.rotation_matrix().transpose();
  for (Rigid3& T : result.T_robot_camera) T = D.inverse() * T;
  result.covariance = turn * knowledge.covariance * turn.transpose();
  result.free_directions = turn * knowledge.free_directions;
  if (knowledge.step.size() > 0) result.step = turn * knowledge.step;
  return result;
}

}  // namespace

Eigen::MatrixXd complement(const Eigen::MatrixXd& directions) {
  const Eigen::Index n = directions.rows();
  if (directions.cols() == 0) return Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd scaled = directions;
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) {
    const double norm = scaled.col(i).norm();
    if (norm > 0.0) scaled.col(i) /= norm;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-6);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  return Q.rightCols(n - qr.rank());
}

Eigen::MatrixXd rig_motion(const std::vector<Rigid3>& T_robot_camera) {
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(T_robot_camera.size()), 6);
  for (std::size_t c = 0; c < T_robot_camera.size(); ++c) {
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(c);
    E.block<6, 6>(row, 0).setIdentity();
    E.block<3, 3>(row, 3) = -skew(T_robot_camera[c].translation);
  }
  return E;
}

// The motion of the rig as one body that brings the cameras from `before` to `now`: where the data tell little of it,
// it may be large, too large for the small differences between cameras to be compared to first order.
Rigid3 common_motion(const std::vector<Rigid3>& before, const std::vector<Rigid3>& now) {
  const Eigen::MatrixXd E = rig_motion(before);
  constexpr double kScatter_m = 1e-4;
  Rigid3 D;
  // Reweighted by the distances, so that a camera that did move does not take the others along.
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::VectorXd rest(E.rows()), weights(E.rows());
    for (std::size_t c = 0; c < before.size(); ++c) {
      const Eigen::Index row = 6 * static_cast<Eigen::Index>(c);
      const Vector6d error = transform_error(D.inverse() * now[c], before[c]);
      const double weight = 1.0 / (kScatter_m + std::hypot(error.head<3>().norm(), kLever_m * error.tail<3>().norm()));
      rest.segment<6>(row) = error;
      weights.segment<3>(row).setConstant(weight);
      weights.segment<3>(row + 3).setConstant(weight * kLever_m * kLever_m);
    }
    const Eigen::MatrixXd normal = E.transpose() * weights.asDiagonal() * E;
    const Vector6d step = normal.ldlt().solve(E.transpose() * weights.cwiseProduct(rest));
    D = D * se3_exp(step);
    if (step.norm() < 1e-12) break;
  }
  return D;
}

Difference difference(const KnownPoses& before, const KnownPoses& after) {
  const Rigid3 D = common_motion(before.T_robot_camera, after.T_robot_camera);
  const KnownPoses now = moved_back(after, D);
  const Eigen::Index n = before.covariance.rows();
  Eigen::MatrixXd free(n, before.free_directions.cols() + now.free_directions.cols());
  free << before.free_directions, now.free_directions;
  const Eigen::MatrixXd Q = complement(free);
  Eigen::VectorXd d = rig_motion(before.T_robot_camera) * se3_log(D);
  for (std::size_t c = 0; c < before.T_robot_camera.size(); ++c)
    d.segment<6>(6 * static_cast<Eigen::Index>(c)) += transform_error(now.T_robot_camera[c], before.T_robot_camera[c]);
  if (now.step.size() > 0) d += now.step;
  Difference result;
  result.rank = static_cast<int>(Q.cols());
  result.information = Eigen::MatrixXd::Zero(n, n);
  if (result.rank > 0) {
    const Eigen::MatrixXd& of_before = now.covariance_before.size() > 0 ? now.covariance_before : before.covariance;
    const Eigen::MatrixXd S = Q.transpose() * (of_before + now.covariance) * Q;
    result.information = Q * S.ldlt().solve(Q.transpose());
  }
  result.gradient = result.information * d;
  result.statistic = d.dot(result.gradient);
  result.T_robot_camera = now.T_robot_camera;
  return result;
}

Explanation explain(const Difference& difference, const Eigen::MatrixXd& E) {
  // A direction that a metre or a radian does not move by a standard deviation is not determined.
  constexpr double kLeastInformation = 1.0;
  const Eigen::MatrixXd A = E.transpose() * difference.information * E;
  const Eigen::VectorXd g = E.transpose() * difference.gradient;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  const Eigen::Index n = A.rows();
  Eigen::Index undetermined = 0;
  while (undetermined < n && solver.eigenvalues()[undetermined] < kLeastInformation) ++undetermined;
  const Eigen::Index rank = n - undetermined;
  const Eigen::MatrixXd V = solver.eigenvectors().rightCols(rank);
  const Eigen::VectorXd inverse = solver.eigenvalues().tail(rank).cwiseInverse();
  Explanation result;
  result.rank = static_cast<int>(rank);
  result.covariance = V * inverse.asDiagonal() * V.transpose();
  result.shift = result.covariance * g;
  result.reduction = g.dot(result.shift);
  result.undetermined = solver.eigenvectors().leftCols(undetermined);
  return result;
}

}  // namespace rigproof::moved
