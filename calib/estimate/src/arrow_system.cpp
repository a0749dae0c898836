#include "rigproof/calib/estimate/arrow_system.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace rigproof::ml {
namespace {

// Information of an unknown that is fixed: its variance vanishes beside every other.
constexpr double kFixedInformation = 1e30;

// Absent unless every eigenvalue is far from zero, which the inverse itself shows: none is below 1 / |A^-1|.
std::optional<Eigen::MatrixXd> inverse_of_regular(const Eigen::MatrixXd& A) {
  constexpr double kFarFromZero = 1e-7;
  const Eigen::LLT<Eigen::MatrixXd> llt(A);
  if (llt.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd inverse = llt.solve(Eigen::MatrixXd::Identity(A.rows(), A.cols()));
  if (!(inverse.norm() * kFarFromZero < 1.0)) return std::nullopt;
  inverse = (0.5 * (inverse + inverse.transpose())).eval();
  return inverse;
}

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
  for (FieldEquations& field : fields) field.with_poses.row(6 * pose + unknown).setZero();
}

void ArrowSystem::fix_global_unknown(int unknown) {
  global.row(unknown).setZero();
  global.col(unknown).setZero();
  global(unknown, unknown) = kFixedInformation;
  ++fixed_unknowns;
  pose_global.col(unknown).setZero();
  global_gradient[unknown] = 0.0;
  for (FieldEquations& field : fields) field.with_globals.row(unknown).setZero();
}

std::optional<EliminatedSystem> EliminatedSystem::eliminate(const ArrowSystem& system, double damping) {
  const int n = system.poses(), globals = system.globals();
  if (!system.fields.empty()) {
    int numbers = 0;
    for (const FieldEquations& field : system.fields) numbers += static_cast<int>(field.gradient.size());
    return 6 * n > numbers ? fields_last(system) : fields_first(system);
  }
  EliminatedSystem result;
  result.log_determinant_ = -system.fixed_unknowns * std::log(kFixedInformation);  // they are none of the unknowns
  result.inverse_pivot_.resize(static_cast<std::size_t>(n));
  result.factor_.resize(static_cast<std::size_t>(n), Matrix6d::Zero());
  Eigen::MatrixXd& forward = result.forward_;
  forward.resize(globals + 1, 6 * n);
  forward.topRows(globals) = system.pose_global.transpose();
  forward.row(globals) = system.pose_gradient.transpose();

  Eigen::MatrixXd whitened(globals + 1, 6 * n);  // (D^-1/2 L^-1 [U g])'
  for (int i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    auto own = forward.middleCols<6>(6 * i);
    Matrix6d pivot = system.diagonal[k];
    pivot.diagonal() *= 1.0 + damping;
    if (i > 0) {
      result.factor_[k] = system.coupling[k] * result.inverse_pivot_[k - 1];
      pivot -= result.factor_[k] * system.coupling[k].transpose();
      own -= forward.middleCols<6>(6 * i - 6).lazyProduct(result.factor_[k].transpose());
    }
    const Eigen::LLT<Matrix6d> llt(pivot);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const Matrix6d inverse_root = llt.matrixL().solve(Matrix6d::Identity());
    result.inverse_pivot_[k].noalias() = inverse_root.transpose() * inverse_root;
    whitened.middleCols<6>(6 * i).noalias() = own.lazyProduct(inverse_root.transpose());
    result.log_determinant_ += 2.0 * log_diagonal(llt.matrixLLT());
  }

  // The gradient as one more global: its row of the complement is the reduced gradient.
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(globals + 1, globals + 1);
  reduced.selfadjointView<Eigen::Lower>().rankUpdate(whitened, -1.0);
  result.schur_ = reduced.topLeftCorner(globals, globals).selfadjointView<Eigen::Lower>();
  result.schur_ += system.global;
  result.schur_.diagonal() += damping * system.global.diagonal();
  result.schur_gradient_ = system.global_gradient + reduced.row(globals).head(globals).transpose();
  return result;
}

void EliminatedSystem::solve_backwards(Eigen::MatrixXd* transposed) const {
  for (int i = static_cast<int>(inverse_pivot_.size()) - 1; i >= 0; --i) {
    const std::size_t k = static_cast<std::size_t>(i);
    auto own = transposed->middleCols<6>(6 * i);
    own = own.lazyProduct(inverse_pivot_[k]).eval();
    if (k + 1 < inverse_pivot_.size()) own -= transposed->middleCols<6>(6 * i + 6).lazyProduct(factor_[k + 1]);
  }
}

bool EliminatedSystem::step(Eigen::VectorXd* pose_step, Eigen::VectorXd* global_step) const {
  const Eigen::LLT<Eigen::MatrixXd> llt(schur_);
  if (llt.info() != Eigen::Success) return false;
  *global_step = -llt.solve(schur_gradient_);
  const Eigen::Index globals = schur_.rows();
  const bool with_fields = response_.size() > 0;
  const Eigen::MatrixXd& by = with_fields ? response_ : forward_;
  Eigen::MatrixXd transposed = -by.row(globals) - global_step->transpose() * by.topRows(globals);
  if (!with_fields) solve_backwards(&transposed);
  *pose_step = transposed.transpose();
  return global_step->allFinite() && pose_step->allFinite();
}

double EliminatedSystem::log_determinant_of_globals() const {
  const Eigen::LLT<Eigen::MatrixXd> llt(schur_);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return 2.0 * log_diagonal(llt.matrixLLT());
}

EliminatedSystem::PoseCovariance EliminatedSystem::pose_covariance(const Eigen::MatrixXd& global_covariance) const {
  const std::size_t n = inverse_pivot_.size();
  Eigen::MatrixXd W = forward_.topRows(schur_.rows());  // (P^-1 U)'
  solve_backwards(&W);
  const Eigen::MatrixXd with_globals = -global_covariance * W;
  PoseCovariance covariance;
  covariance.diagonal.resize(n);
  covariance.with_previous.resize(n, Matrix6d::Zero());
  covariance.with_globals = with_globals.transpose();
  // Backwards through the chain: blocks of P^-1 from those of its factors.
  for (std::size_t i = n; i-- > 0;) {
    covariance.diagonal[i] = inverse_pivot_[i];
    if (i + 1 == n) continue;
    const Matrix6d& L = factor_[i + 1];
    covariance.with_previous[i + 1] = -covariance.diagonal[i + 1] * L;
    covariance.diagonal[i] += L.transpose() * covariance.diagonal[i + 1] * L;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
    const auto own = with_globals.middleCols<6>(at).transpose();
    covariance.diagonal[i] -= own.lazyProduct(W.middleCols<6>(at));
    if (i > 0) covariance.with_previous[i] -= own.lazyProduct(W.middleCols<6>(at - 6));
  }
  return covariance;
}

Eigen::MatrixXd EliminatedSystem::pose_response() const {
  if (response_.size() > 0) return response_;
  Eigen::MatrixXd transposed = forward_;
  solve_backwards(&transposed);
  return transposed;
}

// With Z = P^-1: Z_kj = -L_k+1' Z_k+1,j for j > k, so what the rows after k answer is carried along, backwards.
std::vector<Matrix6d> EliminatedSystem::squares_from_each_pose(const std::vector<Matrix6d>& B) const {
  const std::size_t n = inverse_pivot_.size();
  std::vector<Matrix6d> squares(n);
  Matrix6d Z = Matrix6d::Zero(), answer = Matrix6d::Zero(),
           sum = Matrix6d::Zero();  // Z_kk, sum of Z_kj B_j over j >= k
  for (std::size_t k = n; k-- > 0;) {
    Matrix6d later = Matrix6d::Zero();
    if (k + 1 < n) {
      const Matrix6d& L = factor_[k + 1];
      Z = (inverse_pivot_[k] + L.transpose() * Z * L).eval();
      later = -L.transpose() * answer;
    } else {
      Z = inverse_pivot_[k];
    }
    const Matrix6d own = Z * B[k], cross = B[k].transpose() * later;
    answer = own + later;
    sum += B[k].transpose() * own + cross + cross.transpose();
    squares[k] = sum;
  }
  return squares;
}

GlobalCovariance invert_information(const Eigen::MatrixXd& schur) {
  // Unknowns in units of their own conditional sigma: a metre and a radian then compare.
  const Eigen::VectorXd unit = schur.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * schur * unit.asDiagonal();
  GlobalCovariance result;
  if (const std::optional<Eigen::MatrixXd> inverse = inverse_of_regular(scaled)) {
    result.covariance = unit.asDiagonal() * *inverse * unit.asDiagonal();
    result.free_directions.resize(schur.rows(), 0);
    return result;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double threshold = 1e-11 * std::max(1.0, eigen.eigenvalues().maxCoeff());
  const Eigen::Index free = (eigen.eigenvalues().array() < threshold).count();
  const Eigen::Index determined = schur.rows() - free;
  const Eigen::MatrixXd V = unit.asDiagonal() * eigen.eigenvectors();
  const Eigen::MatrixXd half =
      V.rightCols(determined) * eigen.eigenvalues().tail(determined).cwiseSqrt().cwiseInverse().asDiagonal();
  result.covariance = half * half.transpose();
  result.free_directions = V.leftCols(free);
  return result;
}

}  // namespace rigproof::ml
