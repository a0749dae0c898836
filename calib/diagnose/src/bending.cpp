#include "bending.h"

#include <algorithm>

#include "global_covariance.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/stated_levels.h"

namespace rigproof::ml {

std::optional<GlobalCovariance> stated_covariance(const Preparation& prepared, const Fit& fit) {
  const std::optional<GroupSums> sums = problem_at(prepared, fit, fit.noise).sums_with_leverage(fit.state);
  if (!sums) return std::nullopt;
  return covariance_at(prepared, fit, stated_levels(prepared, fit, *sums));
}

double bent_by(const State& without, const Preparation& prepared, const Fit& with, const GlobalCovariance& covariance) {
  const Layout layout = problem_at(prepared, with, with.noise).layout();
  const Eigen::MatrixXd J = camera_chart(with.state, layout);
  Eigen::MatrixXd joint = J * covariance.covariance * J.transpose();
  // A turning point of which less is known hides nothing: what bends poses bends those between cameras, too.
  constexpr double kMost_m = 0.005;
  PriorSigmas sigmas = prepared.sigmas();
  sigmas.rotation_centre_m = std::min(sigmas.rotation_centre_m, kMost_m);
  add_common_errors(sigmas, is_of_turning_point(with.noise.law.model, prepared.used), &joint);
  double most = 0.0;
  for (const int c : prepared.solved_cameras()) {
    const std::size_t k = static_cast<std::size_t>(c);
    const Vector6d sigma = joint.diagonal().segment<6>(6 * c).cwiseMax(1e-18).cwiseSqrt();
    const auto look = [&](const Rigid3& T) {
      most = std::max(most, transform_error(without.T_robot_camera[k], T).cwiseAbs().cwiseQuotient(sigma).maxCoeff());
    };
    look(with.state.T_robot_camera[k]);
    for (std::size_t i = 0; i < with.step.bodies.size(); ++i)
      if (with.step.bodies[i] == c) look(with.state.second_poses[i]);
  }
  return most;
}

}  // namespace rigproof::ml
