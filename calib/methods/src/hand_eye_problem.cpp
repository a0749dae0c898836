#include "hand_eye_problem.h"

#include <ceres/evaluation_callback.h>
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
// Of the cost, where Ceres stops: by then a pose moves by some nanometres, and each further digit takes as long as the
// one before. polish() gives the rest.
constexpr double kCostFalls = 1e-13;

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

// The pose of a camera in another's frame, and (shift, turn) of it by the parameters of either.
struct MovedPair {
  Rigid3 T;
  Matrix6d by_own, by_other;
  // @param own the camera whose frame it is
  MovedPair(const MovedPose& own, const MovedPose& other) : T(own.T.inverse() * other.T) {
    const Eigen::Matrix3d back = own.T.rotation_matrix().transpose();
    Matrix6d by_pose = Matrix6d::Zero();
    by_pose.topLeftCorner<3, 3>() = by_pose.bottomRightCorner<3, 3>() = back;
    by_other = by_pose * other.derivative;
    by_pose = -by_pose;
    by_pose.topRightCorner<3, 3>() = -back * skew(own.T.translation - other.T.translation);
    by_own = by_pose * own.derivative;
  }
};

// Poses at the solver's parameters, which all terms of a camera or of a pair share: found once for each set of
// parameters.
class SharedPoses : public ceres::EvaluationCallback {
 public:
  explicit SharedPoses(const std::vector<Rigid3>& X) { start_from(X); }

  // The cameras' poses where the parameters are zero, as they are then.
  void start_from(const std::vector<Rigid3>& X) {
    references_ = X;
    errors_.assign(X.size(), std::array<double, 6>{});
    update();
  }
  void PrepareForEvaluation(bool /*with_jacobians*/, bool at_new_point) override {
    if (at_new_point) update();
  }

  double* parameters(std::size_t camera) { return errors_[camera].data(); }
  const MovedPose& camera(std::size_t k) const { return cameras_[k]; }
  const MovedPair& pair(std::size_t own, std::size_t other) const { return pairs_[own * cameras_.size() + other]; }

 private:
  void update() {
    cameras_.clear();
    for (std::size_t k = 0; k < references_.size(); ++k) cameras_.emplace_back(references_[k], errors_[k].data());
    pairs_.clear();
    for (const MovedPose& own : cameras_)
      for (const MovedPose& other : cameras_) pairs_.emplace_back(own, other);
  }

  std::vector<Rigid3> references_;
  std::vector<std::array<double, 6>> errors_;
  std::vector<MovedPose> cameras_;
  std::vector<MovedPair> pairs_;
};

struct MotionCost : ceres::SizedCostFunction<6, 6> {
  Rigid3 A, B;
  std::size_t camera;
  const SharedPoses& poses;

  MotionCost(const Rigid3& A_in, const Rigid3& B_in, std::size_t of_camera, const SharedPoses& shared)
      : A(A_in), B(B_in), camera(of_camera), poses(shared) {}

  bool Evaluate(const double* const* /*errors*/, double* residual, double** jacobians) const override {
    const MovedPose& X = poses.camera(camera);
    const Vector6d r = residual_of(A, X.T, B);
    Eigen::Map<Vector6d>{residual} = r;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMajor<6>>{jacobians[0]} = derivative_of(A, X.T, B, r) * X.derivative;
    return true;
  }
};

// Both directions of a pair, each with half the weight, so that the order of the cameras does not matter.
struct CameraPairCost : ceres::SizedCostFunction<12, 6, 6> {
  Rigid3 B_j, B_k;
  std::size_t camera_j, camera_k;
  const SharedPoses& poses;

  CameraPairCost(const Rigid3& motion_j, const Rigid3& motion_k, std::size_t j, std::size_t k,
                 const SharedPoses& shared)
      : B_j(motion_j), B_k(motion_k), camera_j(j), camera_k(k), poses(shared) {}

  bool Evaluate(const double* const* /*errors*/, double* residuals, double** jacobians) const override {
    const MovedPair &j_k = poses.pair(camera_j, camera_k), &k_j = poses.pair(camera_k, camera_j);
    const Vector6d forward = residual_of(B_j, j_k.T, B_k), backward = residual_of(B_k, k_j.T, B_j);
    Eigen::Map<Vector12d>{residuals} << M_SQRT1_2 * forward, M_SQRT1_2 * backward;
    if (jacobians == nullptr) return true;
    const Matrix6d of_j_k = M_SQRT1_2 * derivative_of(B_j, j_k.T, B_k, forward);
    const Matrix6d of_k_j = M_SQRT1_2 * derivative_of(B_k, k_j.T, B_j, backward);
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor<12>> by_j(jacobians[0]);
      by_j.topRows<6>() = of_j_k * j_k.by_own;
      by_j.bottomRows<6>() = of_k_j * k_j.by_other;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor<12>> by_k(jacobians[1]);
      by_k.topRows<6>() = of_j_k * j_k.by_other;
      by_k.bottomRows<6>() = of_k_j * k_j.by_own;
    }
    return true;
  }
};

struct HeightCost : ceres::SizedCostFunction<1, 6> {
  double height_m;
  std::size_t camera;
  const SharedPoses& poses;

  HeightCost(double height, std::size_t of_camera, const SharedPoses& shared)
      : height_m(height), camera(of_camera), poses(shared) {}

  bool Evaluate(const double* const* /*errors*/, double* residual, double** jacobians) const override {
    residual[0] = poses.camera(camera).T.translation.z() - height_m;
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

// What robot and camera did between two stops: A X = X B.
struct Motions {
  Rigid3 A, B;
};

Motions motions_of(const HandEyeProblem& problem, const MotionTerm& term) {
  const Rigid3& from = problem.odometry[static_cast<std::size_t>(term.from->stop)];
  const Rigid3& to = problem.odometry[static_cast<std::size_t>(term.to->stop)];
  return {from.inverse() * to, relative_view(term.from->T_camera_board, term.to->T_camera_board)};
}

// What the two cameras did: B_j X_jk = X_jk B_k.
Motions motions_of(const CameraPairTerm& term) {
  return {relative_view(term.from_j->T_camera_board, term.to_j->T_camera_board),
          relative_view(term.from_k->T_camera_board, term.to_k->T_camera_board)};
}

// One term with everything that the normal equations need.
struct Block {
  std::unique_ptr<ceres::CostFunction> cost;
  std::vector<std::size_t> cameras;
  double weight = 1.0;
  Eigen::VectorXd residual;
  std::vector<RowMajor<Eigen::Dynamic>> jacobians;
};

// All terms; their costs refer to the poses.
struct Blocks {
  std::unique_ptr<SharedPoses> poses;
  std::vector<Block> motions, pairs, heights;

  std::array<std::vector<Block>*, 3> groups() { return {&motions, &pairs, &heights}; }
  std::array<const std::vector<Block>*, 3> groups() const { return {&motions, &pairs, &heights}; }
};

Blocks make_blocks(const HandEyeProblem& problem) {
  Blocks blocks;
  blocks.poses = std::make_unique<SharedPoses>(problem.X);
  const SharedPoses& poses = *blocks.poses;
  for (const MotionTerm& term : problem.motions) {
    const auto [A, B] = motions_of(problem, term);
    blocks.motions.push_back(
        {std::make_unique<MotionCost>(A, B, term.camera, poses), {term.camera}, term.weight, {}, {}});
  }
  for (const CameraPairTerm& term : problem.pairs) {
    const auto [B_j, B_k] = motions_of(term);
    blocks.pairs.push_back({std::make_unique<CameraPairCost>(B_j, B_k, term.camera_j, term.camera_k, poses),
                            {term.camera_j, term.camera_k},
                            term.weight,
                            {},
                            {}});
  }
  for (const HeightTerm& term : problem.heights)
    blocks.heights.push_back(
        {std::make_unique<HeightCost>(term.height_m, term.camera, poses), {term.camera}, term.weight, {}, {}});
  return blocks;
}

void evaluate(bool with_jacobians, Block* block) {
  const int rows = block->cost->num_residuals();
  block->residual.resize(rows);
  block->jacobians.resize(with_jacobians ? block->cameras.size() : 0);  // old ones would pass for those of here
  std::array<double*, 2> jacobians{};
  for (std::size_t i = 0; i < block->jacobians.size(); ++i) {
    block->jacobians[i].resize(rows, 6);
    jacobians[i] = block->jacobians[i].data();
  }
  block->cost->Evaluate(nullptr, block->residual.data(), with_jacobians ? jacobians.data() : nullptr);
}

void evaluate_at(const std::vector<Rigid3>& X, bool with_jacobians, Blocks* blocks) {
  blocks->poses->start_from(X);
  for (std::vector<Block>* group : blocks->groups())
    for (Block& block : *group) evaluate(with_jacobians, &block);
}

// At problem.X, with Jacobians.
Blocks evaluated(const HandEyeProblem& problem) {
  Blocks blocks = make_blocks(problem);
  evaluate_at(problem.X, true, &blocks);
  return blocks;
}

Eigen::Index row(std::size_t camera) { return 6 * static_cast<Eigen::Index>(camera); }

struct NormalEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;  // J^T r
};

NormalEquations normal_equations(const Blocks& blocks, std::size_t cameras) {
  NormalEquations normal{Eigen::MatrixXd::Zero(row(cameras), row(cameras)), Eigen::VectorXd::Zero(row(cameras))};
  for (const std::vector<Block>* group : blocks.groups()) {
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

void add_blocks(const std::vector<Block>& blocks, ceres::LossFunction* loss, SharedPoses* poses,
                ceres::Problem* problem) {
  for (const Block& block : blocks) {
    std::vector<double*> parameters;
    for (const std::size_t camera : block.cameras) parameters.push_back(poses->parameters(camera));
    problem->AddResidualBlock(block.cost.get(), loss, parameters);
  }
}

// One robust minimisation from problem->X, which it moves.
bool solve_once(const std::array<double, 3>& scales, Blocks* blocks, HandEyeProblem* problem) {
  SharedPoses* poses = blocks->poses.get();
  poses->start_from(problem->X);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.evaluation_callback = poses;
  ceres::CauchyLoss motion_loss(scales[0]), pair_loss(scales[1]), height_loss(scales[2]);
  ceres::Problem ceres_problem(ownership);
  add_blocks(blocks->motions, &motion_loss, poses, &ceres_problem);
  add_blocks(blocks->pairs, &pair_loss, poses, &ceres_problem);
  add_blocks(blocks->heights, &height_loss, poses, &ceres_problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = kCostFalls;
  options.gradient_tolerance = options.parameter_tolerance = 1e-15;
  const ceres::Solver::Summary summary = quiet_solve(options, &ceres_problem);
  for (std::size_t k = 0; k < problem->X.size(); ++k)
    problem->X[k] = apply_transform_error(problem->X[k], Eigen::Map<const Vector6d>(poses->parameters(k)));
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

// Residuals and robust weights at problem->X, in the terms and in the blocks.
void store_residuals(const std::array<double, 3>& scales, bool with_jacobians, Blocks* blocks,
                     HandEyeProblem* problem) {
  evaluate_at(problem->X, with_jacobians, blocks);
  store_residuals(scales[0], &blocks->motions, &problem->motions);
  store_residuals(scales[1], &blocks->pairs, &problem->pairs);
  store_residuals(scales[2], &blocks->heights, &problem->heights);
}

// Where the cost hardly falls half of the digits of the minimum are still open. A few reweighted
// Gauss-Newton steps give the rest, so that the answer does not depend on the frames in which the data are told.
void polish(const std::array<double, 3>& scales, Blocks* blocks, HandEyeProblem* problem) {
  for (int step = 0; step < 5; ++step) {
    store_residuals(scales, true, blocks, problem);
    const NormalEquations normal = normal_equations(*blocks, problem->X.size());
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
      : problem_(problem), declared_(declared), blocks_(evaluated(problem)) {
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
    const Motions motions = motions_of(problem_, term);
    const Matrix6d by_motion = derivative_by_B(motions.A, problem_.X[term.camera], block.residual);
    const auto by_view = relative_view_derivatives(term.from->T_camera_board, term.to->T_camera_board);
    Eigen::Vector2d pnp = Eigen::Vector2d::Zero();
    for (const auto& [view, derivative] : {std::pair(term.from, by_view[0]), std::pair(term.to, by_view[1])}) {
      const Sensitivity D = by_motion * derivative;
      add_response(block, D, view_source(*view));
      pnp += explained(D, view->covariance);
    }
    add_odometry(term, motions.A, block, pnp);
  }

  void add_pair(const CameraPairTerm& term, const Block& block) {
    const auto [B_j, B_k] = motions_of(term);
    const Rigid3 T_j_k = problem_.X[term.camera_j].inverse() * problem_.X[term.camera_k], T_k_j = T_j_k.inverse();
    const Vector6d forward = M_SQRT2 * block.residual.head<6>(), backward = M_SQRT2 * block.residual.tail<6>();
    Sensitivity by_j(12, 6), by_k(12, 6);
    by_j << derivative_by_A(B_j, T_j_k, forward), derivative_by_B(B_k, T_k_j, backward);
    by_k << derivative_by_B(B_j, T_j_k, forward), derivative_by_A(B_k, T_k_j, backward);
    add_pair_views(block, M_SQRT1_2 * by_j, *term.from_j, *term.to_j);
    add_pair_views(block, M_SQRT1_2 * by_k, *term.from_k, *term.to_k);
  }

  void add_pair_views(const Block& block, const Sensitivity& by_motion, const ViewPose& from, const ViewPose& to) {
    const auto by_view = relative_view_derivatives(from.T_camera_board, to.T_camera_board);
    add_response(block, by_motion * by_view[0], view_source(from));
    add_response(block, by_motion * by_view[1], view_source(to));
  }

  void add_odometry(const MotionTerm& term, const Rigid3& A, const Block& block, const Eigen::Vector2d& pnp) {
    const std::size_t from = static_cast<std::size_t>(term.from->stop), to = static_cast<std::size_t>(term.to->stop);
    odometry_.resize(problem_.odometry.size() + 1);
    Eigen::Vector3d unit = Eigen::Vector3d::Zero();  // translation by sigma_t, translation by sigma_r, rotation
    const auto add = [&](const Sensitivity& D, std::size_t index) {
      add_response(block, D, &odometry_[index]);
      unit += Eigen::Vector3d(D.topLeftCorner<3, 2>().squaredNorm(), D.topRightCorner<3, 1>().squaredNorm(),
                              D.bottomRightCorner<3, 1>().squaredNorm());
    };
    const Matrix6d by_A = derivative_by_A(A, problem_.X[term.camera], block.residual);
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
  Blocks blocks = make_blocks(*problem);
  for (int round = 0; round < kRounds; ++round) {
    evaluate_at(problem->X, false, &blocks);
    scales = {loss_scale(blocks.motions), loss_scale(blocks.pairs), loss_scale(blocks.heights)};
    usable = solve_once(scales, &blocks, problem);
  }
  polish(scales, &blocks, problem);
  store_residuals(scales, false, &blocks, problem);
  return usable;
}

Eigen::MatrixXd covariance_of(const HandEyeProblem& problem, const OdometryNoise& declared) {
  return NoisePropagation(problem, declared).covariance();
}

}  // namespace rigproof
