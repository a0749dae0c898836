#include "statement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "global_covariance.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/stated_levels.h"

namespace rigproof::ml {
namespace {

Eigen::MatrixXd chart_of(const Preparation& prepared, const Fit& fit) {
  return camera_chart(fit.state, Layout::of(prepared.used, prepared.priors));
}

// @param turning_point false: as measured from the point about which the robot turns
Eigen::MatrixXd cameras_covariance(const Preparation& prepared, const Fit& fit, const Eigen::MatrixXd& globals,
                                   bool turning_point = true) {
  const Eigen::MatrixXd J = chart_of(prepared, fit);
  Eigen::MatrixXd joint = J * globals * J.transpose();
  const bool is_origin = is_of_turning_point(fit.noise.law.model, prepared.used);
  add_common_errors(prepared.sigmas(), turning_point && is_origin, &joint);
  return joint;
}

NoiseLevels levels_of(const Preparation& prepared, const Fit& fit, const std::optional<GroupSums>& sums) {
  return sums ? stated_levels(prepared, fit, *sums) : fit.noise;
}

// Where the data leave open which odometry model holds, the other one's answer and uncertainty count with its
// probability: the law of total variance, about the answer that is given. Whether it is of use is judged by the
// likelier model alone, as by the likeliest level.
Eigen::MatrixXd with_other_model(const Preparation& prepared, const OdometryChoice& choice,
                                 const Eigen::MatrixXd& joint) {
  const Fit &fit = choice.fit, &other = *choice.other;
  const std::optional<GroupSums> sums = problem_at(prepared, other, other.noise).sums_with_leverage(other.state);
  const auto globals = covariance_at(prepared, other, levels_of(prepared, other, sums));
  if (!globals || globals->free_directions.cols() > 0) return joint;
  const Eigen::MatrixXd other_joint = cameras_covariance(prepared, other, globals->covariance);
  Eigen::VectorXd apart(joint.rows());
  for (std::size_t c = 0; c < fit.state.T_robot_camera.size(); ++c)
    apart.segment<6>(6 * static_cast<Eigen::Index>(c)) =
        transform_error(other.state.T_robot_camera[c], fit.state.T_robot_camera[c]);
  const double share = 1.0 - choice.decision.probability;
  return (1.0 - share) * joint + share * (other_joint + apart * apart.transpose());
}

bool exceeds(const Eigen::MatrixXd& joint, const PosteriorLimits& limits) {
  const std::array<double, 6> limit = limits.each();
  for (Eigen::Index i = 0; i < joint.rows(); ++i)
    if (!(std::sqrt(joint(i, i)) <= limit[static_cast<std::size_t>(i % 6)])) return true;
  return false;
}

// As measured from the turning point: no drive tells more of where that lies, and all else is of use without it. What
// is stated of that, where it is within the limits; else by the levels as they most likely are.
Eigen::MatrixXd gate_covariance(const Preparation& prepared, const Fit& fit, const Examination& found,
                                const Eigen::MatrixXd& globals) {
  Eigen::MatrixXd joint = cameras_covariance(prepared, fit, globals, false);
  if (!found.sums || !exceeds(joint, prepared.options.limits)) return joint;
  const auto at_gate = covariance_at(prepared, fit, gate_levels(prepared, fit, *found.sums));
  return at_gate ? cameras_covariance(prepared, fit, at_gate->covariance, false) : joint;
}

Eigen::MatrixXd normalised(Eigen::MatrixXd directions) {
  for (Eigen::Index column = 0; column < directions.cols(); ++column) {
    const double largest = directions.col(column).cwiseAbs().maxCoeff();
    if (largest > 0.0) directions.col(column) /= largest;
  }
  return directions;
}

// How much of an error that no data tell is in what is stated: that of the models that have it.
double share_of(const CommonError& error, const Preparation& prepared, const OdometryChoice& choice) {
  const double of_other = choice.other ? 1.0 - choice.decision.probability : 0.0;
  const auto has = [&](const Fit& fit) {
    return !error.along_way_only || is_of_turning_point(fit.noise.law.model, prepared.used) ? 1.0 : 0.0;
  };
  return (1.0 - of_other) * has(choice.fit) + (choice.other ? of_other * has(*choice.other) : 0.0);
}

// What no data tell, and what the other odometry model adds.
std::vector<BudgetLine> whole_budget(std::vector<BudgetLine> budget, const Preparation& prepared,
                                     const OdometryChoice& choice, const Eigen::MatrixXd& joint) {
  for (const CommonError& error : common_errors()) {
    const double share = share_of(error, prepared, choice);
    if (share == 0.0) continue;
    Eigen::VectorXd variances = Eigen::VectorXd::Zero(joint.rows());
    for (Eigen::Index i = error.axis; i < joint.rows(); i += 6)
      variances[i] = std::min(share * std::pow(prepared.sigmas().*error.sigma_m, 2), joint(i, i));
    add_to_budget(error.source, variances, &budget);
  }
  Eigen::VectorXd rest = joint.diagonal();
  for (const BudgetLine& line : budget) rest -= line.variances;
  constexpr double kRounding = 1e-6;
  add_to_budget("choice of odometry model", (rest.array() > kRounding * joint.diagonal().array()).select(rest, 0.0),
                &budget);
  return budget;
}

}  // namespace

Statement state_solution(const Preparation& prepared, const OdometryChoice& choice, const Examination& found) {
  const Fit& fit = choice.fit;
  const NoiseLevels levels = levels_of(prepared, fit, found.sums);
  GroupSums sums;
  double cost = 0.0;
  const Problem problem = problem_at(prepared, fit, levels);
  ArrowSystem system = problem.linearise(fit.state, Weighting::kInformation, &cost, &sums);
  cost += prepared.repeating.cost();
  Statement stated{levels, std::move(system), std::move(sums), cost, std::nullopt};
  const std::optional<SolvedEquations> solved = solve_equations(prepared.repeating, problem, fit.state);
  if (!solved) return stated;
  const GlobalCovariance globals = solved->of_globals();
  Eigen::MatrixXd joint = cameras_covariance(prepared, fit, globals.covariance);
  const Eigen::MatrixXd gate_joint = gate_covariance(prepared, fit, found, globals.covariance);
  if (choice.other && globals.free_directions.cols() == 0) joint = with_other_model(prepared, choice, joint);
  std::vector<BudgetLine> budget = whole_budget(budget_of(problem, fit.state, *solved), prepared, choice, joint);
  stated.uncertainty = Uncertainty{globals, joint, gate_joint, std::move(budget),
                                   normalised(chart_of(prepared, fit) * globals.free_directions)};
  return stated;
}

}  // namespace rigproof::ml
