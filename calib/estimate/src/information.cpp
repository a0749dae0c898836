#include "rigproof/calib/estimate/information.h"

#include <string>

#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/declared_problem.h"
#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

void require(bool holds, const char* field, std::size_t actual, std::size_t expected) {
  if (holds) return;
  throw Error(std::string("bound: ") + field + ": " + std::to_string(actual) + " given, the observations have " +
              std::to_string(expected));
}

ml::State to_state(const Observations& observations, const CalibrationState& values) {
  const std::size_t cameras = observations.cameras.size(), stops = observations.stops.size();
  require(values.T_robot_camera.size() == cameras, "T_robot_camera", values.T_robot_camera.size(), cameras);
  require(values.depth_scale.size() == cameras, "depth_scale", values.depth_scale.size(), cameras);
  require(values.T_world_more_boards.size() == observations.more_boards.size(), "T_world_more_boards",
          values.T_world_more_boards.size(), observations.more_boards.size());
  require(values.T_world_robot.size() == stops, "T_world_robot", values.T_world_robot.size(), stops);
  return ml::state_from(values);
}

}  // namespace

InformationBound cramer_rao_bound(const Observations& observations, const CalibrationState& values,
                                  const CalibrationNoise& noise) {
  const ml::State state = to_state(observations, values);
  const ml::Problem problem = ml::declared_problem(observations, noise);
  ml::RemovedErrors repeating = ml::none_removed(observations, noise.priors);
  ml::add_stated_fine_fields(observations, &repeating);
  const ml::ArrowSystem system = repeating.errors.any()
                                     ? problem.linearise_with(repeating, state, ml::Weighting::kUnit)
                                     : problem.linearise(state, ml::Weighting::kUnit, nullptr, nullptr);
  const auto eliminated = ml::EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) throw Error("bound: the information of the robot poses is not positive definite");
  const ml::GlobalCovariance all = ml::invert_information(eliminated->schur());
  const Eigen::Index count = problem.layout().globals();
  const ml::GlobalCovariance globals{all.covariance.topLeftCorner(count, count), all.free_directions.topRows(count)};
  const Eigen::MatrixXd J = ml::camera_chart(state, problem.layout());

  InformationBound bound;
  bound.joint = J * globals.covariance * J.transpose();
  ml::add_common_errors(noise.priors, ml::is_of_turning_point(noise.law.model, observations), &bound.joint);
  bound.free_directions = J * globals.free_directions;
  const int cameras = problem.layout().cameras;
  for (int c = 0; c < cameras; ++c) bound.camera_to_robot.push_back(bound.joint.block<6, 6>(6 * c, 6 * c));
  for (int j = 0; j < cameras; ++j) {
    for (int k = j + 1; k < cameras; ++k) {
      const Eigen::MatrixXd P = ml::pair_chart(values.T_robot_camera, j, k);
      bound.camera_to_camera.push_back({j, k, P * bound.joint * P.transpose()});
    }
  }
  return bound;
}

}  // namespace rigproof
