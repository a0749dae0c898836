#include "held.h"

#include <Eigen/Cholesky>

#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/declared_problem.h"

namespace rigproof::moved {
namespace {

// The optimum with the rig moved back to where it was; the robot takes the motion over, the board stays.
ml::State moved_back(const KnownPoses& before, const CalibrationState& optimum) {
  const Rigid3 D = common_motion(before.T_robot_camera, optimum.T_robot_camera);
  CalibrationState start = optimum;
  for (Rigid3& T : start.T_robot_camera) T = D.inverse() * T;
  for (Rigid3& T : start.T_world_robot) T = T * D;
  return ml::state_from(start);
}

Eigen::VectorXd errors(const std::vector<Rigid3>& now, const std::vector<Rigid3>& before) {
  Eigen::VectorXd result(6 * static_cast<Eigen::Index>(now.size()));
  for (std::size_t c = 0; c < now.size(); ++c)
    result.segment<6>(6 * static_cast<Eigen::Index>(c)) = transform_error(now[c], before[c]);
  return result;
}

// Gauss and Newton, with the previous result as a loose prior of all but what may have moved.
class Holder {
 public:
  Holder(const KnownPoses& before, const Eigen::MatrixXd& moved, const ml::Problem& problem)
      : before_(before), problem_(problem) {
    // Factor on standard deviations: the prior decides where the observations know so much less, and nothing elsewhere.
    constexpr double kLoose = 30.0;
    constexpr double kLeastVariance = 1e-14;  // files round
    Eigen::MatrixXd open(moved.rows(), before.free_directions.cols() + moved.cols());
    open << before.free_directions, moved;
    const Eigen::MatrixXd Q = complement(open);
    Eigen::MatrixXd S = kLoose * kLoose * Q.transpose() * before.covariance * Q;
    S.diagonal().array() += kLeastVariance;
    information_ = Q * S.ldlt().solve(Q.transpose());
    information_.diagonal().array() += 1.0;  // what nobody knows stays within about a metre and a radian
  }

  bool hold(ml::State* state) const {
    constexpr int kIterations = 20;
    constexpr double kSettled = 1e-10;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      ml::ArrowSystem system = problem_.linearise(*state, ml::Weighting::kRobust, nullptr, nullptr);
      add_prior(*state, &system);
      const auto eliminated = ml::EliminatedSystem::eliminate(system, 0.0);
      Eigen::VectorXd pose_step, global_step;
      if (!eliminated || !eliminated->step(&pose_step, &global_step)) return false;
      *state = ml::moved(*state, problem_.layout(), pose_step, global_step);
      if (global_step.norm() < kSettled) break;
    }
    return true;
  }

 private:
  void add_prior(const ml::State& state, ml::ArrowSystem* system) const {
    const Eigen::MatrixXd J = ml::camera_chart(state, problem_.layout());
    const Eigen::VectorXd r = errors(state.T_robot_camera, before_.T_robot_camera);
    system->global += J.transpose() * information_ * J;
    system->global_gradient += J.transpose() * information_ * r;
  }

  const KnownPoses& before_;
  const ml::Problem& problem_;
  Eigen::MatrixXd information_;
};

}  // namespace

std::optional<KnownPoses> held_knowledge(const KnownPoses& before, const Eigen::MatrixXd& moved,
                                         const Observations& used, const CalibrationState& optimum,
                                         const CalibrationNoise& noise) {
  const ml::Problem problem = ml::declared_problem(used, noise);
  ml::State state = moved_back(before, optimum);
  if (!Holder(before, moved, problem).hold(&state)) return std::nullopt;
  const auto at = [&](ml::Weighting weighting) {
    return ml::EliminatedSystem::eliminate(problem.linearise(state, weighting, nullptr, nullptr), 0.0);
  };
  const auto slope = at(ml::Weighting::kSlope), unit = at(ml::Weighting::kUnit);
  if (!slope || !unit) return std::nullopt;
  const Eigen::MatrixXd J = ml::camera_chart(state, problem.layout());
  const ml::GlobalCovariance own = ml::invert_information(slope->schur()), all = ml::invert_information(unit->schur());
  KnownPoses knowledge;
  knowledge.T_robot_camera = state.T_robot_camera;
  knowledge.covariance = J * all.covariance * J.transpose() / ml::cauchy_moments(2).efficiency;
  knowledge.free_directions = J * all.free_directions;
  knowledge.step = -J * (own.covariance * slope->schur_gradient());
  return knowledge;
}

}  // namespace rigproof::moved
