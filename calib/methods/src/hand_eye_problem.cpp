#include "hand_eye_problem.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "hand_eye.h"
#include "quiet_solve.h"
#include "rigproof/core/median.h"

namespace rigproof {
namespace {

// Loss scales below what any PnP or depth camera resolves would make rounding look like outliers.
constexpr double kMinLossScale = 1e-4;
constexpr double kLossMedians = 3.0;
constexpr int kRounds = 3;

template <int kRows>
using RowMajor = Eigen::Matrix<double, kRows, 6, Eigen::RowMajor>;

// A camera's pose off its reference by the six parameters of the solver, an error of transform_error().
struct MovedPose {
  Rigid3 T;
  // Of (shift, turn along the parent's axes) by the parameters.
  Matrix6d derivative = Matrix6d::Identity();
  MovedPose(const Rigid3& reference, const double* error)
      : T(apply_transform_error(reference, Eigen::Map<const Vector6d>(error))) {
    derivative.bottomRightCorner<3, 3>() = so3_left_jacobian(Eigen::Map<const Eigen::Vector3d>(error + 3));
  }
};

Vector6d residual_of(const Rigid3& A, const Rigid3& X, const Rigid3& B) {
  Vector6d residual;
  hand_eye_residual(RigidOf<double>::from(A), RigidOf<double>::from(X), RigidOf<double>::from(B), residual.data());
  return residual;
}

// Of that residual by (shift, turn along the parent's axes) of X.
Matrix6d derivative_of(const Rigid3& A, const Rigid3& X, const Rigid3& B, const Vector6d& residual) {
  const Eigen::Matrix3d R_A = A.rotation_matrix();
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>() = R_A - Eigen::Matrix3d::Identity();
  D.topRightCorner<3, 3>() = skew(X.rotation * B.translation);
  D.bottomRightCorner<3, 3>() = so3_left_jacobian_inverse(residual.tail<3>()) * X.rotation_matrix().transpose() *
                                (R_A.transpose() - Eigen::Matrix3d::Identity());
  return D;
}

// Of the same residual by (shift, turn along the parent's axes) of A.
Matrix6d derivative_by_A(const Rigid3& A, const Rigid3& X, const Vector6d& residual) {
  Matrix6d D = Matrix6d::Identity();
  D.topRightCorner<3, 3>() = -skew(A.rotation * X.translation);
  D.bottomRightCorner<3, 3>() =
      -so3_left_jacobian_inverse(residual.tail<3>()) * (A.rotation * X.rotation).conjugate().toRotationMatrix();
  return D;
}

// And by that of B.
Matrix6d derivative_by_B(const Rigid3& A, const Rigid3& X, const Vector6d& residual) {
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>() = -X.rotation_matrix();
  D.bottomRightCorner<3, 3>() = so3_left_jacobian_inverse(residual.tail<3>()) *
                                (X.rotation.conjugate() * A.rotation.conjugate() * X.rotation).toRotationMatrix();
  return D;
}

struct MotionCost : ceres::SizedCostFunction<6, 6> {
  Rigid3 A, B, X_reference;

  MotionCost(const Rigid3& A_in, const Rigid3& B_in, const Rigid3& reference)
      : A(A_in), B(B_in), X_reference(reference) {}

  bool Evaluate(const double* const* error, double* residual, double** jacobians) const override {
    const MovedPose X(X_reference, error[0]);
    const Vector6d r = residual_of(A, X.T, B);
    Eigen::Map<Vector6d>{residual} = r;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMajor<6>>{jacobians[0]} = derivative_of(A, X.T, B, r) * X.derivative;
    return true;
  }
};

// Both directions of a pair, each with half the weight, so that the order of the cameras does not matter.
struct CameraPairCost : ceres::SizedCostFunction<12, 6, 6> {
  Rigid3 B_j, B_k, X_reference_j, X_reference_k;

  CameraPairCost(const Rigid3& motion_j, const Rigid3& motion_k, const Rigid3& reference_j, const Rigid3& reference_k)
      : B_j(motion_j), B_k(motion_k), X_reference_j(reference_j), X_reference_k(reference_k) {}

  static Vector12d residual(const Rigid3& B_j, const Rigid3& B_k, const Rigid3& X_j, const Rigid3& X_k) {
    Vector12d r;
    r << residual_of(B_j, X_j.inverse() * X_k, B_k), residual_of(B_k, X_k.inverse() * X_j, B_j);
    return M_SQRT1_2 * r;
  }

  bool Evaluate(const double* const* errors, double* residuals, double** jacobians) const override {
    const MovedPose j(X_reference_j, errors[0]), k(X_reference_k, errors[1]);
    const Vector12d r = residual(B_j, B_k, j.T, k.T);
    Eigen::Map<Vector12d>{residuals} = r;
    if (jacobians == nullptr) return true;
    const Rigid3 T_j_k = j.T.inverse() * k.T, T_k_j = T_j_k.inverse();
    const Matrix6d of_j_k = M_SQRT1_2 * derivative_of(B_j, T_j_k, B_k, M_SQRT2 * r.head<6>());
    const Matrix6d of_k_j = M_SQRT1_2 * derivative_of(B_k, T_k_j, B_j, M_SQRT2 * r.tail<6>());
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor<12>> by_j(jacobians[0]);
      by_j.topRows<6>() = of_j_k * by_first(j.T, k.T) * j.derivative;
      by_j.bottomRows<6>() = of_k_j * by_second(k.T) * j.derivative;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor<12>> by_k(jacobians[1]);
      by_k.topRows<6>() = of_j_k * by_second(j.T) * k.derivative;
      by_k.bottomRows<6>() = of_k_j * by_first(k.T, j.T) * k.derivative;
    }
    return true;
  }

 private:
  // (shift, turn) of first^-1 second by those of either.
  static Matrix6d by_second(const Rigid3& first) {
    const Eigen::Matrix3d back = first.rotation_matrix().transpose();
    Matrix6d D = Matrix6d::Zero();
    D.topLeftCorner<3, 3>() = D.bottomRightCorner<3, 3>() = back;
    return D;
  }
  static Matrix6d by_first(const Rigid3& first, const Rigid3& second) {
    Matrix6d D = -by_second(first);
    D.topRightCorner<3, 3>() = D.topLeftCorner<3, 3>() * skew(first.translation - second.translation);
    return D;
  }
};

struct HeightCost : ceres::SizedCostFunction<1, 6> {
  double height_m, reference_m;

  HeightCost(double height, double reference) : height_m(height), reference_m(reference) {}

  bool Evaluate(const double* const* error, double* residual, double** jacobians) const override {
    residual[0] = reference_m + error[0][2] - height_m;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 1, 6>>{jacobians[0]} = Eigen::Matrix<double, 1, 6>::Unit(2);
    return true;
  }
};

Rigid3 relative_view(const Rigid3& from, const Rigid3& to) { return from * to.inverse(); }

// (shift, turn) of that by those of either view.
std::array<Matrix6d, 2> relative_view_derivatives(const Rigid3& from, const Rigid3& to) {
  const Eigen::Matrix3d R = (from.rotation * to.rotation.conjugate()).toRotationMatrix();
  Matrix6d by_from = Matrix6d::Identity(), by_to = Matrix6d::Zero();
  by_from.topRightCorner<3, 3>() = skew(R * to.translation);
  by_to.topLeftCorner<3, 3>() = by_to.bottomRightCorner<3, 3>() = -R;
  by_to.topRightCorner<3, 3>() = -R * skew(to.translation);
  return {by_from, by_to};
}

// (shift, turn) of first * moved * last by those of what is moved.
Matrix6d product_derivative(const Rigid3& first, const Rigid3& moved, const Rigid3& last) {
  const Eigen::Matrix3d R = first.rotation_matrix();
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>() = D.bottomRightCorner<3, 3>() = R;
  D.topRightCorner<3, 3>() = -R * skew(moved.rotation * last.translation);
  return D;
}

std::unique_ptr<MotionCost> cost_of(const HandEyeProblem& problem, const MotionTerm& term) {
  const Rigid3& from = problem.odometry[static_cast<std::size_t>(term.from->stop)];
  const Rigid3& to = problem.odometry[static_cast<std::size_t>(term.to->stop)];
  return std::make_unique<MotionCost>(
      from.inverse() * to, relative_view(term.from->T_camera_board, term.to->T_camera_board), problem.X[term.camera]);
}

std::unique_ptr<CameraPairCost> cost_of(const HandEyeProblem& problem, const CameraPairTerm& term) {
  return std::make_unique<CameraPairCost>(relative_view(term.from_j->T_camera_board, term.to_j->T_camera_board),
                                          relative_view(term.from_k->T_camera_board, term.to_k->T_camera_board),
                                          problem.X[term.camera_j], problem.X[term.camera_k]);
}

std::unique_ptr<HeightCost> cost_of(const HandEyeProblem& problem, const HeightTerm& term) {
  return std::make_unique<HeightCost>(term.height_m, problem.X[term.camera].translation.z());
}

// One term with everything that the normal equations need.
struct Block {
  std::unique_ptr<ceres::CostFunction> cost;
  std::vector<std::size_t> cameras;
  Eigen::VectorXd residual;
  std::vector<RowMajor<Eigen::Dynamic>> jacobians;
  double weight = 1.0;
};

// Residual and Jacobians at error zero, that is at problem.X.
void evaluate(Block* block) {
  constexpr std::array<double, 6> kZero{};
  const int rows = block->cost->num_residuals();
  block->residual.resize(rows);
  block->jacobians.resize(block->cameras.size());
  std::vector<const double*> parameters(block->cameras.size(), kZero.data());
  std::vector<double*> jacobians;
  for (auto& jacobian : block->jacobians) {
    jacobian.resize(rows, 6);
    jacobians.push_back(jacobian.data());
  }
  block->cost->Evaluate(parameters.data(), block->residual.data(), jacobians.data());
}

Block make_block(std::unique_ptr<ceres::CostFunction> cost, std::vector<std::size_t> cameras, double weight) {
  Block block;
  block.cost = std::move(cost);
  block.cameras = std::move(cameras);
  block.weight = weight;
  evaluate(&block);
  return block;
}

struct Blocks {
  std::vector<Block> motions, pairs, heights;
};

Blocks make_blocks(const HandEyeProblem& problem) {
  Blocks blocks;
  for (const MotionTerm& term : problem.motions)
    blocks.motions.push_back(make_block(cost_of(problem, term), {term.camera}, term.weight));
  for (const CameraPairTerm& term : problem.pairs)
    blocks.pairs.push_back(make_block(cost_of(problem, term), {term.camera_j, term.camera_k}, term.weight));
  for (const HeightTerm& term : problem.heights)
    blocks.heights.push_back(make_block(cost_of(problem, term), {term.camera}, term.weight));
  return blocks;
}

Eigen::Index row(std::size_t camera) { return 6 * static_cast<Eigen::Index>(camera); }

struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;  // J^T r
};

NormalEquations normal_equations(const Blocks& blocks, std::size_t cameras) {
  NormalEquations normal{Eigen::MatrixXd::Zero(row(cameras), row(cameras)), Eigen::VectorXd::Zero(row(cameras))};
  for (const std::vector<Block>* group : {&blocks.motions, &blocks.pairs, &blocks.heights}) {
    for (const Block& block : *group) {
      for (std::size_t a = 0; a < block.cameras.size(); ++a) {
        const Eigen::MatrixXd weighted = block.weight * block.jacobians[a].transpose();
        normal.g.segment<6>(row(block.cameras[a])) += weighted * block.residual;
        for (std::size_t b = 0; b < block.cameras.size(); ++b)
          normal.H.block<6, 6>(row(block.cameras[a]), row(block.cameras[b])) += weighted * block.jacobians[b];
      }
    }
  }
  // Planar motion says nothing about a height: without a plane it stays where it started.
  for (std::size_t camera = 0; camera < cameras; ++camera)
    if (normal.H(row(camera) + 2, row(camera) + 2) < 1e-9) normal.H(row(camera) + 2, row(camera) + 2) = 1.0;
  return normal;
}

double loss_scale(const std::vector<Block>& blocks) {
  std::vector<double> norms;
  for (const Block& block : blocks) norms.push_back(block.residual.norm());
  return std::max(kMinLossScale, kLossMedians * median(std::move(norms)));
}

using Errors = std::vector<std::array<double, 6>>;

void add_blocks(const std::vector<Block>& blocks, ceres::LossFunction* loss, Errors* errors, ceres::Problem* problem) {
  for (const Block& block : blocks) {
    std::vector<double*> parameters;
    for (const std::size_t camera : block.cameras) parameters.push_back((*errors)[camera].data());
    problem->AddResidualBlock(block.cost.get(), loss, parameters);
  }
}

// One robust minimisation from problem->X, which it moves.
bool solve_once(const Blocks& blocks, const std::array<double, 3>& scales, HandEyeProblem* problem) {
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss motion_loss(scales[0]), pair_loss(scales[1]), height_loss(scales[2]);
  ceres::Problem ceres_problem(ownership);
  Errors errors(problem->X.size(), std::array<double, 6>{});
  add_blocks(blocks.motions, &motion_loss, &errors, &ceres_problem);
  add_blocks(blocks.pairs, &pair_loss, &errors, &ceres_problem);
  add_blocks(blocks.heights, &height_loss, &errors, &ceres_problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-15;
  const ceres::Solver::Summary summary = quiet_solve(options, &ceres_problem);
  for (std::size_t k = 0; k < problem->X.size(); ++k)
    problem->X[k] = apply_transform_error(problem->X[k], Eigen::Map<const Vector6d>(errors[k].data()));
  return summary.IsSolutionUsable();
}

template <typename Term>
void store_residuals(double scale, std::vector<Block>* blocks, std::vector<Term>* terms) {
  for (std::size_t i = 0; i < terms->size(); ++i) {
    Block& block = (*blocks)[i];
    (*terms)[i].residual = block.residual;
    (*terms)[i].weight = block.weight = 1.0 / (1.0 + block.residual.squaredNorm() / (scale * scale));
  }
}

// Residuals and robust weights at problem->X, in the terms and in the blocks that are returned.
Blocks store_residuals(const std::array<double, 3>& scales, HandEyeProblem* problem) {
  Blocks blocks = make_blocks(*problem);
  store_residuals(scales[0], &blocks.motions, &problem->motions);
  store_residuals(scales[1], &blocks.pairs, &problem->pairs);
  store_residuals(scales[2], &blocks.heights, &problem->heights);
  return blocks;
}

// Ceres stops when the cost no longer falls, which leaves half of the digits of the minimum. A few reweighted
// Gauss-Newton steps give the rest, so that the answer does not depend on the frames in which the data are told.
void polish(const std::array<double, 3>& scales, HandEyeProblem* problem) {
  for (int step = 0; step < 5; ++step) {
    const NormalEquations normal = normal_equations(store_residuals(scales, problem), problem->X.size());
    const Eigen::VectorXd errors = normal.H.ldlt().solve(-normal.g);
    // Far from the minimum nothing is polished.
    if (!(errors.norm() < 1e-5)) return;
    for (std::size_t k = 0; k < problem->X.size(); ++k)
      problem->X[k] = apply_transform_error(problem->X[k], errors.segment<6>(row(k)));
    if (errors.norm() < 1e-12) return;
  }
}

// Linear response to noise -------------------------------------------------------------------------------------------

using Sensitivity = Eigen::MatrixXd;  // of a residual to a source of noise

// The columns of x, y and yaw.
Sensitivity planar(const Matrix6d& D) {
  Sensitivity columns(6, 3);
  columns << D.leftCols<2>(), D.rightCols<1>();
  return columns;
}

// How the normal equations' right side reacts to one source of noise, summed over the blocks that it enters.
struct Source {
  Eigen::MatrixXd response;  // 6K x dimensions
  Eigen::MatrixXd covariance;
};

class NoisePropagation {
 public:
  NoisePropagation(const HandEyeProblem& problem, const OdometryNoise& declared)
      : problem_(problem), declared_(declared), blocks_(make_blocks(problem)) {
    size_ = 6 * static_cast<Eigen::Index>(problem.X.size());
  }

  Eigen::MatrixXd covariance() {
    for (std::size_t i = 0; i < problem_.motions.size(); ++i) add_motion(problem_.motions[i], blocks_.motions[i]);
    for (std::size_t i = 0; i < problem_.pairs.size(); ++i) add_pair(problem_.pairs[i], blocks_.pairs[i]);
    Eigen::MatrixXd meat = height_noise();
    for (const Source& source : views_)
      if (source.response.size() > 0) meat += source.response * source.covariance * source.response.transpose();
    const Eigen::Vector3d odometry_variance = estimate_odometry();
    for (const Source& source : odometry_)
      if (source.response.size() > 0)
        meat += source.response * odometry_variance.asDiagonal() * source.response.transpose();
    const Eigen::MatrixXd H_inverse =
        normal_equations(blocks_, problem_.X.size()).H.ldlt().solve(Eigen::MatrixXd::Identity(size_, size_));
    const Eigen::MatrixXd covariance = H_inverse * meat * H_inverse.transpose();
    return 0.5 * (covariance + covariance.transpose());
  }

 private:
  void add_response(const Block& block, const Sensitivity& D, Source* source) const {
    if (source->response.size() == 0) source->response = Eigen::MatrixXd::Zero(size_, D.cols());
    for (std::size_t a = 0; a < block.cameras.size(); ++a)
      source->response.middleRows<6>(row(block.cameras[a])) += block.weight * block.jacobians[a].transpose() * D;
  }

  Source* view_source(const ViewPose& view) {
    const std::size_t index = static_cast<std::size_t>(view.view);
    if (views_.size() <= index) views_.resize(index + 1);
    views_[index].covariance = view.covariance;
    return &views_[index];
  }

  // The part of the residual's variance that the PnP of one view explains.
  static Eigen::Vector2d explained(const Sensitivity& D, const Matrix6d& covariance) {
    const Matrix6d C = D * covariance * D.transpose();
    return {C.topLeftCorner<3, 3>().trace(), C.bottomRightCorner<3, 3>().trace()};
  }

  void add_motion(const MotionTerm& term, const Block& block) {
    const std::unique_ptr<MotionCost> cost = cost_of(problem_, term);
    const Matrix6d by_motion = derivative_by_B(cost->A, cost->X_reference, block.residual);
    const auto by_view = relative_view_derivatives(term.from->T_camera_board, term.to->T_camera_board);
    Eigen::Vector2d pnp = Eigen::Vector2d::Zero();
    for (const auto& [view, derivative] : {std::pair(term.from, by_view[0]), std::pair(term.to, by_view[1])}) {
      const Sensitivity D = by_motion * derivative;
      add_response(block, D, view_source(*view));
      pnp += explained(D, view->covariance);
    }
    add_odometry(term, *cost, block, pnp);
  }

  void add_pair(const CameraPairTerm& term, const Block& block) {
    const std::unique_ptr<CameraPairCost> cost = cost_of(problem_, term);
    const Rigid3 T_j_k = cost->X_reference_j.inverse() * cost->X_reference_k, T_k_j = T_j_k.inverse();
    const Vector6d forward = M_SQRT2 * block.residual.head<6>(), backward = M_SQRT2 * block.residual.tail<6>();
    Sensitivity by_j(12, 6), by_k(12, 6);
    by_j << derivative_by_A(cost->B_j, T_j_k, forward), derivative_by_B(cost->B_k, T_k_j, backward);
    by_k << derivative_by_B(cost->B_j, T_j_k, forward), derivative_by_A(cost->B_k, T_k_j, backward);
    add_pair_views(block, M_SQRT1_2 * by_j, *term.from_j, *term.to_j);
    add_pair_views(block, M_SQRT1_2 * by_k, *term.from_k, *term.to_k);
  }

  void add_pair_views(const Block& block, const Sensitivity& by_motion, const ViewPose& from, const ViewPose& to) {
    const auto by_view = relative_view_derivatives(from.T_camera_board, to.T_camera_board);
    add_response(block, by_motion * by_view[0], view_source(from));
    add_response(block, by_motion * by_view[1], view_source(to));
  }

  void add_odometry(const MotionTerm& term, const MotionCost& cost, const Block& block, const Eigen::Vector2d& pnp) {
    const std::size_t from = static_cast<std::size_t>(term.from->stop), to = static_cast<std::size_t>(term.to->stop);
    odometry_.resize(problem_.odometry.size() + 1);
    Eigen::Vector3d unit = Eigen::Vector3d::Zero();  // translation by sigma_t, translation by sigma_r, rotation
    const auto add = [&](const Sensitivity& D, std::size_t index) {
      add_response(block, D, &odometry_[index]);
      unit += Eigen::Vector3d(D.topLeftCorner<3, 2>().squaredNorm(), D.topRightCorner<3, 1>().squaredNorm(),
                              D.bottomRightCorner<3, 1>().squaredNorm());
    };
    const Matrix6d by_A = derivative_by_A(cost.A, cost.X_reference, block.residual);
    if (declared_.model == OdometryModel::kPerPose) {
      const auto by_pose = pose_sensitivities(by_A, from, to);
      add(by_pose[0], from);
      add(by_pose[1], to);
    } else {
      for (std::size_t step = from; step < to; ++step) add(step_sensitivity(by_A, from, to, step), step);
    }
    if (block.weight < kTrustedWeight) return;
    excess_ += Eigen::Vector2d(block.residual.head<3>().squaredNorm(), block.residual.tail<3>().squaredNorm());
    explained_ += pnp;
    unit_ += unit;
    ++trusted_motions_;
  }

  Sensitivity step_sensitivity(const Matrix6d& by_A, std::size_t from, std::size_t to, std::size_t step) const {
    const std::vector<Rigid3>& T = problem_.odometry;
    return planar(by_A * product_derivative(T[from].inverse() * T[step], T[step].inverse() * T[step + 1],
                                            T[step + 1].inverse() * T[to]));
  }

  // By the first and by the last pose of a motion, along the world's axes.
  std::array<Sensitivity, 2> pose_sensitivities(const Matrix6d& by_A, std::size_t from, std::size_t to) const {
    const Rigid3 &T_from = problem_.odometry[from], &T_to = problem_.odometry[to];
    const Rigid3 back = T_from.inverse();
    Matrix6d by_to = product_derivative(back, T_to, Rigid3());
    Matrix6d by_from = -by_to;
    by_from.topRightCorner<3, 3>() = back.rotation_matrix() * skew(T_to.translation - T_from.translation);
    return {planar(by_A * by_from), planar(by_A * by_to)};
  }

  // Variances of (x, y, yaw) that explain what PnP leaves of the residuals.
  Eigen::Vector3d estimate_odometry() const {
    Eigen::Vector2d variance(0.0, 0.0);
    // Three planar residuals a motion, three parameters a camera fitted to them.
    const double count = trusted_motions_, fitted = static_cast<double>(problem_.X.size());
    const double redundancy = count > fitted ? count / (count - fitted) : 2.0;
    if (unit_(2) > 0.0) variance(1) = std::max(0.0, (redundancy * excess_(1) - explained_(1)) / unit_(2));
    if (unit_(0) > 0.0)
      variance(0) = std::max(0.0, (redundancy * excess_(0) - explained_(0) - unit_(1) * variance(1)) / unit_(0));
    variance(0) = std::max(variance(0), std::pow(declared_.sigma_xy_m.value_or(0.0), 2));
    variance(1) = std::max(variance(1), std::pow(declared_.sigma_yaw_rad.value_or(0.0), 2));
    return {variance(0), variance(0), variance(1)};
  }

  Eigen::MatrixXd height_noise() const {
    Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(size_, size_);
    Eigen::VectorXd scale = Eigen::VectorXd::Zero(size_);
    for (const HeightTerm& term : problem_.heights) {
      const Eigen::Index z = row(term.camera) + 2;
      // A frame whose height is further off than its sigma says is as uncertain as that.
      const double sigma = std::max(term.sigma_m, std::abs(term.residual(0)));
      meat(z, z) += std::pow(term.weight * sigma, 2);
      scale(z) += term.weight * term.height_m * problem_.depth_scale_sigma[term.camera];
    }
    meat.diagonal() += scale.cwiseAbs2();
    return meat;
  }

  static constexpr double kTrustedWeight = 0.25;

  const HandEyeProblem& problem_;
  const OdometryNoise& declared_;
  const Blocks blocks_;
  Eigen::Index size_ = 0;
  std::vector<Source> views_, odometry_;
  Eigen::Vector2d excess_ = Eigen::Vector2d::Zero(), explained_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d unit_ = Eigen::Vector3d::Zero();
  int trusted_motions_ = 0;
};

}  // namespace

bool minimise(HandEyeProblem* problem) {
  bool usable = true;
  std::array<double, 3> scales{};
  // The loss scales follow the residuals, which follow the minimum: a few rounds settle both.
  for (int round = 0; round < kRounds; ++round) {
    const Blocks blocks = make_blocks(*problem);
    scales = {loss_scale(blocks.motions), loss_scale(blocks.pairs), loss_scale(blocks.heights)};
    usable = solve_once(blocks, scales, problem);
  }
  polish(scales, problem);
  store_residuals(scales, problem);
  return usable;
}

Eigen::MatrixXd covariance_of(const HandEyeProblem& problem, const OdometryNoise& declared) {
  return NoisePropagation(problem, declared).covariance();
}

}  // namespace rigproof
