#include "memroc_reference_cost.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>

#include "hand_eye.h"
#include "quiet_solve.h"

namespace rigproof::rivals {
namespace {

// Rotation vector, then translation.
using Parameters = std::array<double, 6>;

Parameters parameters_of(const Rigid3& X) {
  const Eigen::Vector3d phi = so3_log(X.rotation);
  return {phi.x(), phi.y(), phi.z(), X.translation.x(), X.translation.y(), X.translation.z()};
}

Rigid3 pose_of(const Parameters& p) {
  return Rigid3(so3_exp(Eigen::Vector3d(p[0], p[1], p[2])), Eigen::Vector3d(p[3], p[4], p[5]));
}

template <typename T>
RigidOf<T> pose_from(const T* p) {
  T q[4];
  ceres::AngleAxisToQuaternion(p, q);
  return {Eigen::Quaternion<T>(q[0], q[1], q[2], q[3]), Eigen::Matrix<T, 3, 1>(p[3], p[4], p[5])};
}

template <typename T>
Eigen::Matrix<T, 3, 1> rotation_vector(const Eigen::Quaternion<T>& rotation) {
  const T q[4] = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  Eigen::Matrix<T, 3, 1> phi;
  ceres::QuaternionToAngleAxis(q, phi.data());
  return phi;
}

// The difference of rotation vectors jumps where one of them passes pi: that is how the program compares rotations.
template <typename T>
void reference_residual(const RigidOf<T>& A, const RigidOf<T>& X, const RigidOf<T>& B, bool geodesic, T* residual) {
  if (geodesic) return hand_eye_residual(A, X, B, residual);
  const RigidOf<T> left = A * X, right = X * B;
  Eigen::Map<Eigen::Matrix<T, 3, 1>> translation(residual), rotation(residual + 3);
  translation = left.translation - right.translation;
  rotation = rotation_vector(left.rotation) - rotation_vector(right.rotation);
}

struct MotionCost {
  ReferenceMotion motion;
  bool geodesic;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const RigidOf<T> X = pose_from(x);
    reference_residual(RigidOf<T>::from(motion.A), X, RigidOf<T>::from(motion.B), geodesic, residual);
    residual[6] = motion.height_m ? X.translation.z() - *motion.height_m : T(0.0);
    return true;
  }
  static ceres::CostFunction* Create(const ReferenceMotion& motion, bool geodesic) {
    return new ceres::AutoDiffCostFunction<MotionCost, 7, 6>(new MotionCost{motion, geodesic});
  }
};

struct PairCost {
  ReferencePair pair;
  bool geodesic;

  template <typename T>
  bool operator()(const T* x_j, const T* x_k, T* residual) const {
    const RigidOf<T> X_jk = pose_from(x_j).inverse() * pose_from(x_k);
    reference_residual(RigidOf<T>::from(pair.B_j), X_jk, RigidOf<T>::from(pair.B_k), geodesic, residual);
    return true;
  }
  static ceres::CostFunction* Create(const ReferencePair& pair, bool geodesic) {
    return new ceres::AutoDiffCostFunction<PairCost, 6, 6, 6>(new PairCost{pair, geodesic});
  }
};

struct HeightCost {
  double height_m;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    residual[0] = x[5] - height_m;
    return true;
  }
  static ceres::CostFunction* Create(double height_m) {
    return new ceres::AutoDiffCostFunction<HeightCost, 1, 6>(new HeightCost{height_m});
  }
};

}  // namespace

void minimise_reference(ReferenceProblem* problem) {
  if (problem->motions.empty() && problem->pairs.empty()) return;
  std::vector<Parameters> parameters;
  for (const Rigid3& X : problem->X) parameters.push_back(parameters_of(X));
  ceres::Problem ceres_problem;
  for (const ReferenceMotion& motion : problem->motions)
    ceres_problem.AddResidualBlock(MotionCost::Create(motion, problem->geodesic), new ceres::CauchyLoss(1.0),
                                   parameters[motion.camera].data());
  for (const ReferencePair& pair : problem->pairs)
    ceres_problem.AddResidualBlock(PairCost::Create(pair, problem->geodesic), new ceres::CauchyLoss(1.0),
                                   parameters[pair.camera_j].data(), parameters[pair.camera_k].data());
  for (const ReferenceHeight& height : problem->heights)
    ceres_problem.AddResidualBlock(HeightCost::Create(height.height_m), new ceres::CauchyLoss(1.0),
                                   parameters[height.camera].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 500;
  quiet_solve(options, &ceres_problem);
  for (std::size_t k = 0; k < problem->X.size(); ++k) problem->X[k] = pose_of(parameters[k]);
}

}  // namespace rigproof::rivals
