#include "ml/arrow_system.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace rigproof::ml {
namespace {

// Information of an unknown that is fixed: its variance vanishes beside every other.
constexpr double kFixedInformation = 1e30;

double log_diagonal(const Eigen::MatrixXd& triangle) { return triangle.diagonal().array().abs().log().sum(); }

}  // namespace

ArrowSystem::ArrowSystem(int poses, int globals)
    : diagonal(static_cast<std::size_t>(poses), Matrix6d::Zero()),
      coupling(static_cast<std::size_t>(poses), Matrix6d::Zero()),
      pose_global(Eigen::MatrixXd::Zero(6 * poses, globals)),
      global(Eigen::MatrixXd::Zero(globals, globals)),
      pose_gradient(Eigen::VectorXd::Zero(6 * poses)),
      global_gradient(Eigen::VectorXd::Zero(globals)) {}

void ArrowSystem::fix_pose_unknown(int pose, int unknown) {
  const std::size_t i = static_cast<std::size_t>(pose);
  diagonal[i].row(unknown).setZero();
  diagonal[i].col(unknown).setZero();
  diagonal[i](unknown, unknown) = kFixedInformation;
  ++fixed_unknowns;
  coupling[i].row(unknown).setZero();
  if (i + 1 < coupling.size()) coupling[i + 1].col(unknown).setZero();
  pose_global.row(6 * pose + unknown).setZero();
  pose_gradient[6 * pose + unknown] = 0.0;
}

void ArrowSystem::fix_global_unknown(int unknown) {
  global.row(unknown).setZero();
  global.col(unknown).setZero();
  global(unknown, unknown) = kFixedInformation;
  ++fixed_unknowns;
  pose_global.col(unknown).setZero();
  global_gradient[unknown] = 0.0;
}

std::optional<EliminatedSystem> EliminatedSystem::eliminate(const ArrowSystem& system, double damping) {
  const int n = system.poses(), globals = system.globals();
  EliminatedSystem result;
  result.log_determinant_ = -system.fixed_unknowns * std::log(kFixedInformation);  // they are none of the unknowns
  result.inverse_pivot_.resize(static_cast<std::size_t>(n));
  result.factor_.resize(static_cast<std::size_t>(n), Matrix6d::Zero());
  result.solved_.resize(6 * n, globals + 1);
  result.solved_ << system.pose_global, system.pose_gradient;

  for (int i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    Matrix6d pivot = system.diagonal[k];
    pivot.diagonal() *= 1.0 + damping;
    if (i > 0) {
      result.factor_[k] = system.coupling[k] * result.inverse_pivot_[k - 1];
      pivot -= result.factor_[k] * system.coupling[k].transpose();
      result.solved_.middleRows<6>(6 * i) -= (result.factor_[k] * result.solved_.middleRows<6>(6 * i - 6)).eval();
    }
    const Eigen::LLT<Matrix6d> llt(pivot);
    if (llt.info() != Eigen::Success) return std::nullopt;
    result.inverse_pivot_[k] = llt.solve(Matrix6d::Identity());
    result.log_determinant_ += 2.0 * log_diagonal(llt.matrixLLT());
  }
  for (int i = n - 1; i >= 0; --i) {
    const std::size_t k = static_cast<std::size_t>(i);
    result.solved_.middleRows<6>(6 * i) = (result.inverse_pivot_[k] * result.solved_.middleRows<6>(6 * i)).eval();
    if (i + 1 < n)
      result.solved_.middleRows<6>(6 * i) -=
          (result.factor_[k + 1].transpose() * result.solved_.middleRows<6>(6 * i + 6)).eval();
  }

  Eigen::MatrixXd damped = system.global;
  damped.diagonal() *= 1.0 + damping;
  const Eigen::MatrixXd reduced = system.pose_global.transpose() * result.solved_;
  result.schur_ = damped - reduced.leftCols(globals);
  result.schur_ = 0.5 * (result.schur_ + result.schur_.transpose()).eval();
  result.schur_gradient_ = system.global_gradient - reduced.col(globals);
  return result;
}

bool EliminatedSystem::step(Eigen::VectorXd* pose_step, Eigen::VectorXd* global_step) const {
  const Eigen::LLT<Eigen::MatrixXd> llt(schur_);
  if (llt.info() != Eigen::Success) return false;
  *global_step = -llt.solve(schur_gradient_);
  const int globals = static_cast<int>(schur_.rows());
  *pose_step = -solved_.col(globals) - solved_.leftCols(globals) * *global_step;
  return global_step->allFinite() && pose_step->allFinite();
}

double EliminatedSystem::log_determinant_of_globals() const {
  const Eigen::LLT<Eigen::MatrixXd> llt(schur_);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return 2.0 * log_diagonal(llt.matrixLLT());
}

EliminatedSystem::PoseCovariance EliminatedSystem::pose_covariance(const Eigen::MatrixXd& global_covariance) const {
  const std::size_t n = inverse_pivot_.size();
  const auto W = solved_.leftCols(schur_.rows());
  PoseCovariance covariance;
  covariance.diagonal.resize(n);
  covariance.with_previous.resize(n, Matrix6d::Zero());
  covariance.with_globals = -W * global_covariance;
  // Backwards through the chain: blocks of P^-1 from those of its factors.
  for (std::size_t i = n; i-- > 0;) {
    covariance.diagonal[i] = inverse_pivot_[i];
    if (i + 1 == n) continue;
    const Matrix6d& L = factor_[i + 1];
    covariance.with_previous[i + 1] = -covariance.diagonal[i + 1] * L;
    covariance.diagonal[i] += L.transpose() * covariance.diagonal[i + 1] * L;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto rows = covariance.with_globals.middleRows<6>(6 * static_cast<Eigen::Index>(i));
    covariance.diagonal[i] -= rows * W.middleRows<6>(6 * static_cast<Eigen::Index>(i)).transpose();
    if (i > 0) covariance.with_previous[i] -= rows * W.middleRows<6>(6 * static_cast<Eigen::Index>(i) - 6).transpose();
  }
  return covariance;
}

GlobalCovariance invert_information(const Eigen::MatrixXd& schur) {
  // Unknowns in units of their own conditional sigma: a metre and a radian then compare.
  const Eigen::VectorXd unit = schur.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * schur * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double threshold = 1e-11 * std::max(1.0, eigen.eigenvalues().maxCoeff());
  const Eigen::Index free = (eigen.eigenvalues().array() < threshold).count();
  const Eigen::Index determined = schur.rows() - free;
  const Eigen::MatrixXd V = unit.asDiagonal() * eigen.eigenvectors();
  GlobalCovariance result;
  const Eigen::MatrixXd half =
      V.rightCols(determined) * eigen.eigenvalues().tail(determined).cwiseSqrt().cwiseInverse().asDiagonal();
  result.covariance = half * half.transpose();
  result.free_directions = V.leftCols(free);
  return result;
}

}  // namespace rigproof::ml
