#include "held.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "kept_errors.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/declared_problem.h"
#include "rigproof/calib/estimate/repeating_covariance.h"

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

// Errors of cameras along the axes of the earlier robot, along those of one that has moved by D.
Eigen::MatrixXd turn_of_all(const Rigid3& D, Eigen::Index rows) {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(rows, rows);
  for (Eigen::Index i = 0; i < rows; i += 3) turn.block<3, 3>(i, i) = D.rotation_matrix();
  return turn;
}

/// The new observations, what is left of that which repeats in every image of a lens and a board that nobody knows
/// exactly, and what an earlier drive left of errors that last.
struct Seen {
  ml::Problem problem;
  ml::RemovedErrors repeating;
  std::optional<KeptErrors> kept = std::nullopt;

  ml::ArrowSystem linearise(const ml::State& state, ml::Weighting weighting) const {
    ml::ArrowSystem system = repeating.errors.any() ? problem.linearise_with(repeating, state, weighting)
                                                    : problem.linearise(state, weighting, nullptr, nullptr);
    if (kept) kept->add_to(state, &system);
    return system;
  }
  // Of the problem's own globals, which come before the errors that repeat.
  Eigen::Index globals() const { return problem.layout().globals(); }
  std::optional<ml::GlobalCovariance> covariance(const ml::State& state) const {
    const auto add_kept = [&](ml::ArrowSystem* system) {
      if (kept) kept->add_to(state, system);
    };
    if (repeating.errors.any()) {
      const auto solved = ml::solve_equations(repeating, problem, state, add_kept);
      if (!solved) return std::nullopt;
      return solved->of_globals();
    }
    const auto unit = ml::EliminatedSystem::eliminate(linearise(state, ml::Weighting::kUnit), 0.0);
    if (!unit) return std::nullopt;
    ml::GlobalCovariance all = ml::invert_information(unit->schur());
    all.covariance /= ml::cauchy_moments(2).efficiency;
    return all;
  }
};

// Of the views that are used, as it was found.
ml::RemovedErrors of_views(const Observations& used, const CalibrationNoise& noise, const ml::RemovedErrors* found) {
  ml::RemovedErrors repeating = ml::none_removed(used, noise.priors);
  if (found == nullptr) return repeating;
  repeating.errors = found->errors;
  repeating.value = found->value;
  repeating.fine = found->fine;
  repeating.beyond_stated = found->beyond_stated;
  return repeating;
}

// As the earlier drive saw them, where it doubted the lens: few images hardly tell.
void take_fine_fields(const LastingErrors& lasting, const Observations& used, ml::RemovedErrors* repeating) {
  for (std::size_t c = 0; c < repeating->fine.size(); ++c) {
    if (repeating->errors.field(static_cast<int>(c)) < 0) continue;  // its lens is believed now
    const std::string& camera = used.cameras[c].name;
    const bool doubted =
        std::any_of(lasting.unknowns.begin(), lasting.unknowns.end(), [&](const LastingErrors::Unknown& unknown) {
          return unknown.of.camera == camera && unknown.name == ml::row_of(ml::Nuisance::kLens).parts.front().name;
        });
    if (!doubted) continue;
    std::vector<ml::RemovedErrors::Fine::Grid> grids;
    for (const LastingErrors::FineGrid& grid : lasting.fine_fields)
      if (grid.camera == camera) grids.push_back({grid.cells, grid.sigma_px, grid.share});
    ml::describe_by(grids, static_cast<int>(c), used, repeating);
  }
}

// Gauss and Newton, with the previous result as a loose prior of all but what may have moved.
class Holder {
 public:
  Holder(const KnownPoses& before, const Eigen::MatrixXd& moved, const Seen& seen) : before_(before), seen_(seen) {
    // Of standard deviations: decides where the observations know thirty times less, and nothing elsewhere.
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
      ml::ArrowSystem system = seen_.linearise(*state, ml::Weighting::kRobust);
      add_prior(*state, &system);
      const auto eliminated = ml::EliminatedSystem::eliminate(system, 0.0);
      Eigen::VectorXd pose_step, global_step;
      if (!eliminated || !eliminated->step(&pose_step, &global_step)) return false;
      // What is left of errors that repeat enters linearly, so that each step is from what was taken out.
      const Eigen::VectorXd own_step = global_step.head(seen_.globals());
      *state = ml::moved(*state, seen_.problem.layout(), pose_step, own_step);
      if (own_step.norm() < kSettled) break;
    }
    return true;
  }

 private:
  void add_prior(const ml::State& state, ml::ArrowSystem* system) const {
    const Eigen::Index own = seen_.globals();
    const Eigen::MatrixXd J = ml::camera_chart(state, seen_.problem.layout());
    const Eigen::VectorXd r = errors(state.T_robot_camera, before_.T_robot_camera);
    system->global.topLeftCorner(own, own) += J.transpose() * information_ * J;
    system->global_gradient.head(own) += J.transpose() * information_ * r;
  }

  const KnownPoses& before_;
  const Seen& seen_;
  Eigen::MatrixXd information_;
};

}  // namespace

std::optional<KnownPoses> held_knowledge(const KnownPoses& before, const Eigen::MatrixXd& moved,
                                         const Observations& used, const CalibrationState& optimum,
                                         const CalibrationNoise& noise, const ml::RemovedErrors* repeating) {
  Seen seen{ml::declared_problem(used, noise), of_views(used, noise, repeating)};
  if (before.lasting) {
    take_fine_fields(*before.lasting, used, &seen.repeating);
    seen.kept.emplace(*before.lasting, seen.problem);
  }
  ml::State state = moved_back(before, optimum);
  if (!Holder(before, moved, seen).hold(&state)) return std::nullopt;
  const auto slope = ml::EliminatedSystem::eliminate(seen.linearise(state, ml::Weighting::kSlope), 0.0);
  const std::optional<ml::GlobalCovariance> all = seen.covariance(state);
  if (!slope || !all) return std::nullopt;
  Eigen::MatrixXd J = ml::camera_chart(state, seen.problem.layout());
  const Eigen::MatrixXd turn = turn_of_all(common_motion(before.T_robot_camera, state.T_robot_camera), J.rows());
  if (seen.kept) J -= turn * seen.kept->cameras_by_globals();
  const ml::GlobalCovariance own = ml::invert_information(slope->schur());
  KnownPoses knowledge;
  knowledge.T_robot_camera = state.T_robot_camera;
  knowledge.covariance = J * all->covariance * J.transpose();
  knowledge.free_directions = J * all->free_directions;
  knowledge.step = -J * (own.covariance.topRows(seen.globals()) * slope->schur_gradient());
  if (!seen.kept) return knowledge;
  knowledge.step -= turn * seen.kept->shift_of_cameras(state);
  knowledge.covariance_before = seen.kept->covariance_left(before.covariance);
  return knowledge;
}

}  // namespace rigproof::moved
