// Elimination where the unknowns of fields couple with poses and globals.
#include <Eigen/Cholesky>
#include <algorithm>

#include "rigproof/calib/estimate/arrow_system.h"

namespace rigproof::ml {
namespace {

// Poses, then globals; below the diagonal.
Eigen::MatrixXd all_of(const ArrowSystem& system) {
  const Eigen::Index poses = system.pose_gradient.size(), globals = system.globals();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(poses + globals, poses + globals);
  for (std::size_t i = 0; i < system.diagonal.size(); ++i) {
    const auto at = 6 * static_cast<Eigen::Index>(i);
    A.block<6, 6>(at, at) = system.diagonal[i];
    if (i > 0) A.block<6, 6>(at, at - 6) = system.coupling[i];
  }
  A.bottomLeftCorner(globals, poses) = system.pose_global.transpose();
  A.bottomRightCorner(globals, globals) = system.global;
  return A;
}

// Which of poses and globals a field couples with: a camera does not see the board at every stop.
std::vector<int> coupled_with(const FieldEquations& field) {
  std::vector<int> coupled;
  const auto poses = static_cast<int>(field.with_poses.rows()), globals = static_cast<int>(field.with_globals.rows());
  for (int i = 0; i < poses; ++i)
    if (!field.with_poses.row(i).isZero(0.0)) coupled.push_back(i);
  for (int i = 0; i < globals; ++i)
    if (!field.with_globals.row(i).isZero(0.0)) coupled.push_back(poses + i);
  return coupled;
}

Eigen::MatrixXd couplings_of(const FieldEquations& field, const std::vector<int>& coupled) {
  Eigen::MatrixXd couplings(static_cast<Eigen::Index>(coupled.size()), field.own.rows());
  const auto poses = static_cast<int>(field.with_poses.rows());
  for (std::size_t i = 0; i < coupled.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (coupled[i] < poses)
      couplings.row(row) = field.with_poses.row(coupled[i]);
    else
      couplings.row(row) = field.with_globals.row(coupled[i] - poses);
  }
  return couplings;
}

// @param A below the diagonal
void eliminate(const FieldEquations& field, Eigen::MatrixXd* A, Eigen::VectorXd* gradient) {
  const std::vector<int> coupled = coupled_with(field);
  const Eigen::LLT<Eigen::MatrixXd> own(field.own);
  const Eigen::MatrixXd by_root = own.matrixL().solve(couplings_of(field, coupled).transpose());
  Eigen::MatrixXd explained = Eigen::MatrixXd::Zero(by_root.cols(), by_root.cols());
  explained.selfadjointView<Eigen::Lower>().rankUpdate(by_root.transpose());
  const Eigen::VectorXd of_gradient = by_root.transpose() * own.matrixL().solve(field.gradient);
  for (std::size_t j = 0; j < coupled.size(); ++j) {
    (*gradient)[coupled[j]] -= of_gradient[static_cast<Eigen::Index>(j)];
    for (std::size_t i = j; i < coupled.size(); ++i)
      (*A)(coupled[i], coupled[j]) -= explained(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
}

// The same equations with the fields' unknowns as the last globals.
ArrowSystem with_fields_as_globals(const ArrowSystem& system) {
  Eigen::Index numbers = 0;
  for (const FieldEquations& field : system.fields) numbers += field.gradient.size();
  const Eigen::Index globals = system.globals();
  ArrowSystem all(system.poses(), static_cast<int>(globals + numbers));
  all.diagonal = system.diagonal;
  all.coupling = system.coupling;
  all.fixed_unknowns = system.fixed_unknowns;
  all.pose_global.leftCols(globals) = system.pose_global;
  all.global.topLeftCorner(globals, globals) = system.global;
  all.pose_gradient = system.pose_gradient;
  all.global_gradient.head(globals) = system.global_gradient;
  Eigen::Index at = globals;
  for (const FieldEquations& field : system.fields) {
    const Eigen::Index size = field.gradient.size();
    all.pose_global.middleCols(at, size) = field.with_poses;
    all.global.block(0, at, globals, size) = field.with_globals;
    all.global.block(at, 0, size, globals) = field.with_globals.transpose();
    all.global.block(at, at, size, size) = field.own.selfadjointView<Eigen::Lower>();
    all.global_gradient.segment(at, size) = field.gradient;
    at += size;
  }
  return all;
}

}  // namespace

FieldEquations::FieldEquations(int poses, int globals, int numbers)
    : own(Eigen::MatrixXd::Identity(numbers, numbers)),
      with_poses(PoseRows::Zero(6 * poses, numbers)),
      with_globals(Eigen::MatrixXd::Zero(globals, numbers)),
      gradient(Eigen::VectorXd::Zero(numbers)) {}

Eigen::VectorXd FieldEquations::step(const Eigen::VectorXd& pose_step, const Eigen::VectorXd& global_step) const {
  return -Eigen::LLT<Eigen::MatrixXd>(own).solve(gradient + with_poses.transpose() * pose_step +
                                                 with_globals.transpose() * global_step);
}

Eigen::MatrixXd FieldEquations::columns_of_inverse(const Eigen::MatrixXd& of_poses,
                                                   const Eigen::MatrixXd& of_globals) const {
  const Eigen::MatrixXd coupled = of_poses * with_poses + of_globals * with_globals;
  return -Eigen::LLT<Eigen::MatrixXd>(own).solve(coupled.transpose()).transpose();
}

// Poses are then no chain any more: for drives whose poses are fewer than the fields' unknowns.
std::optional<EliminatedSystem> EliminatedSystem::fields_first(const ArrowSystem& system) {
  const Eigen::Index poses = system.pose_gradient.size(), globals = system.globals();
  Eigen::MatrixXd A = all_of(system);
  Eigen::VectorXd gradient(poses + globals);
  gradient << system.pose_gradient, system.global_gradient;
  for (const FieldEquations& field : system.fields) ml::eliminate(field, &A, &gradient);
  const Eigen::LLT<Eigen::MatrixXd> of_poses(A.topLeftCorner(poses, poses));
  if (of_poses.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd right(poses, globals + 1);
  right << A.bottomLeftCorner(globals, poses).transpose(), gradient.head(poses);
  of_poses.matrixL().solveInPlace(right);
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(globals + 1, globals + 1);
  reduced.selfadjointView<Eigen::Lower>().rankUpdate(right.transpose(), -1.0);
  EliminatedSystem result;
  result.schur_ = reduced.topLeftCorner(globals, globals) + A.bottomRightCorner(globals, globals);
  result.schur_ = result.schur_.selfadjointView<Eigen::Lower>().toDenseMatrix();
  result.schur_gradient_ = gradient.tail(globals) + reduced.row(globals).head(globals).transpose();
  of_poses.matrixU().solveInPlace(right);
  result.response_ = right.transpose();
  return result;
}

// Linear in the number of poses.
std::optional<EliminatedSystem> EliminatedSystem::fields_last(const ArrowSystem& system) {
  const auto without_poses = eliminate(with_fields_as_globals(system), 0.0);
  if (!without_poses) return std::nullopt;
  const Eigen::MatrixXd& S = without_poses->schur_;
  const Eigen::VectorXd& g = without_poses->schur_gradient_;
  const Eigen::Index globals = system.globals(), numbers = S.rows() - globals;
  const Eigen::LLT<Eigen::MatrixXd> of_fields(S.bottomRightCorner(numbers, numbers));
  if (of_fields.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd by_fields(numbers, globals + 1);
  by_fields << S.bottomLeftCorner(numbers, globals), g.tail(numbers);
  const Eigen::MatrixXd followed = of_fields.solve(by_fields);
  EliminatedSystem result;
  const Eigen::MatrixXd reduced = S.topRightCorner(globals, numbers) * followed;
  result.schur_ = S.topLeftCorner(globals, globals) - reduced.leftCols(globals);
  result.schur_ = (0.5 * (result.schur_ + result.schur_.transpose())).eval();
  result.schur_gradient_ = g.head(globals) - reduced.col(globals);
  const Eigen::MatrixXd response = without_poses->pose_response();
  result.response_.resize(globals + 1, response.cols());
  result.response_.topRows(globals) = response.topRows(globals);
  result.response_.row(globals) = response.bottomRows<1>();
  result.response_ -= followed.transpose() * response.middleRows(globals, numbers);
  return result;
}

}  // namespace rigproof::ml
