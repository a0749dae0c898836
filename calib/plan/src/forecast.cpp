#include "forecast.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/calib/estimate/odometry_way.h"
#include "rigproof/calib/estimate/problem.h"
#include "rigproof/calib/estimate/residuals.h"
#include "rigproof/core/error.h"

namespace rigproof::suggest {
namespace {

constexpr double kNoInformation = 1e6;  // sigma [m, rad] of odometry that is left out

// Eliminates every pose but the last one.
ml::ArrowSystem condensed(const ml::ArrowSystem& system) {
  const int last = system.poses() - 1;
  ml::ArrowSystem result(1, system.globals());
  Matrix6d diagonal = system.diagonal.front();
  Eigen::MatrixXd U = system.pose_global.topRows(6);
  result.global = system.global;
  for (int i = 0; i < last; ++i) {
    const std::size_t next = static_cast<std::size_t>(i) + 1;
    const Eigen::LLT<Matrix6d> llt(diagonal);
    const Eigen::MatrixXd solved = llt.solve(U);
    const Matrix6d& L = system.coupling[next];
    result.global -= U.transpose() * solved;
    const Matrix6d eliminated = L * llt.solve(L.transpose());
    diagonal = system.diagonal[next] - eliminated;
    U = (system.pose_global.middleRows(6 * (i + 1), 6) - L * solved).eval();
  }
  result.diagonal.front() = diagonal;
  result.pose_global = U;
  return result;
}

Observations without_views(Observations observations) {
  observations.board_views.clear();
  observations.ground_planes.clear();
  observations.board_planes.clear();
  return observations;
}

}  // namespace

ml::NoiseLevels expected_levels(const ml::Basis& basis) {
  return basis.levels.law.along_way ? ml::per_increment(basis.levels, basis.used) : basis.levels;
}

Forecast::Forecast(const CalibrationSoFar& knowledge)
    : knowledge_(knowledge),
      state_(knowledge.determined ? knowledge.basis.state : ml::state_from(knowledge.estimate.state)),
      levels_(expected_levels(knowledge.basis)),
      priors_(knowledge.basis.priors),
      layout_(ml::Layout::of(knowledge.basis.used, priors_)),
      base_(condensed(knowledge.determined ? knowledge.basis.system
                                           : linearised(knowledge.basis.used, knowledge.basis.levels, state_))),
      first_is_last_(knowledge.basis.used.stops.size() == 1) {}

// Residuals do not count: what is foreseen has none, and a start from afar only its own.
ml::ArrowSystem Forecast::linearised(const Observations& observations, const ml::NoiseLevels& levels,
                                     const ml::State& state) const {
  ml::Problem problem(observations, priors_, levels);
  for (std::size_t c = 0; c < knowledge_.has_pose.size(); ++c) problem.camera_fixed[c] = !knowledge_.has_pose[c];
  return problem.linearise(state, ml::Weighting::kUnit, nullptr, nullptr);
}

StopInformation Forecast::information_of(const Foresight& foresight, const Place& place) const {
  const Rigid3 T_world_robot = place.T_world_robot();
  Observations one = without_views(knowledge_.basis.used);
  one.stops.clear();
  foresight.append_stop(T_world_robot, T_world_robot, &one);
  for (Board& board : one.more_boards) board.place.reset();  // the stops so far have that already
  ml::State state = state_;
  state.poses = {ml::RobotPose::from_transform(T_world_robot)};
  // By itself: absolute odometry counts, increments are linked later.
  ml::NoiseLevels levels = levels_;
  if (levels.law.model == OdometryModel::kPerIncrement) {
    levels.law.model = OdometryModel::kPerPose;
    levels.odometry_xy_m = levels.odometry_yaw_rad = kNoInformation;
  }
  const ml::ArrowSystem all = linearised(one, levels, state);
  ml::ArrowSystem priors_alone = linearised(without_views(one), levels, state);
  // There no board is seen, and each stays where it is.
  for (const BoardView& view : one.board_views) {
    priors_alone.global.middleRows<6>(layout_.board(view.board)).setZero();
    priors_alone.global.middleCols<6>(layout_.board(view.board)).setZero();
  }
  return {state.poses.front(), all.diagonal.front(), all.pose_global, all.global - priors_alone.global};
}

Stop stop_at(const ml::RobotPose& pose) {
  Stop stop;
  stop.x_m = pose.x_m;
  stop.y_m = pose.y_m;
  stop.yaw_rad = pose.yaw_rad;
  return stop;
}

// The odometry between the poses `index` and `index` + 1 of the system.
void Forecast::link(const ml::RobotPose& from, const ml::RobotPose& to, int index, ml::ArrowSystem* system) const {
  const ml::IncrementResidual residual = ml::increment_residual(
      from, to, state_.odometry_errors(),
      ml::veering_increment(stop_at(from), stop_at(to), knowledge_.basis.used.odometry_noise.rotation_centre_m));
  const Eigen::Vector3d inverse =
      Eigen::Vector3d(levels_.odometry_xy_m, levels_.odometry_xy_m, levels_.odometry_yaw_rad).cwiseInverse();
  const Eigen::Matrix3d A = inverse.asDiagonal() * residual.by_from, B = inverse.asDiagonal() * residual.by_to;
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(3, layout_.globals());
  for (int part = 0; part < 2; ++part)
    if (priors_.sigma(ml::Nuisance::kOdometryFactors, 0, part) > 0.0)
      G.col(layout_.place(ml::Nuisance::kOdometryFactors) + part) = inverse.cwiseProduct(residual.by_factors.col(part));
  if (priors_.sigma(ml::Nuisance::kOdometryVeer) > 0.0)
    G.col(layout_.place(ml::Nuisance::kOdometryVeer)) = inverse.cwiseProduct(residual.by_veer);
  const std::size_t a = static_cast<std::size_t>(index), b = a + 1;
  system->diagonal[a].topLeftCorner<3, 3>() += A.transpose() * A;
  system->diagonal[b].topLeftCorner<3, 3>() += B.transpose() * B;
  system->coupling[b].topLeftCorner<3, 3>() += B.transpose() * A;
  system->pose_global.middleRows(6 * index, 3) += A.transpose() * G;
  system->pose_global.middleRows(6 * (index + 1), 3) += B.transpose() * G;
  system->global += G.transpose() * G;
}

std::optional<Eigen::MatrixXd> Forecast::with_stops(const std::vector<const StopInformation*>& stops) const {
  const int count = static_cast<int>(stops.size());
  ml::ArrowSystem system(count + 1, layout_.globals());
  system.diagonal.front() = base_.diagonal.front();
  system.pose_global.topRows(6) = base_.pose_global;
  system.global = base_.global;
  const bool increments = levels_.law.model == OdometryModel::kPerIncrement;
  for (int i = 0; i < count; ++i) {
    const StopInformation& stop = *stops[static_cast<std::size_t>(i)];
    system.diagonal[static_cast<std::size_t>(i) + 1] = stop.diagonal;
    system.pose_global.middleRows(6 * (i + 1), 6) = stop.pose_global;
    system.global += stop.global;
  }
  for (int i = 0; increments && i < count; ++i)
    link(i == 0 ? state_.poses.back() : stops[static_cast<std::size_t>(i) - 1]->pose,
         stops[static_cast<std::size_t>(i)]->pose, i, &system);
  if (increments && first_is_last_)
    for (int unknown = 0; unknown < 3; ++unknown) system.fix_pose_unknown(0, unknown);
  const std::optional<ml::EliminatedSystem> eliminated = ml::EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  return eliminated->schur();
}

void Forecast::add_common_errors(Errors errors, Eigen::MatrixXd* joint) const {
  const bool turning_point = ml::is_of_turning_point(knowledge_.basis.levels.law.model, knowledge_.basis.used);
  ml::add_common_errors(knowledge_.estimate.noise.priors, errors == Errors::kAll && turning_point, joint);
}

std::optional<Eigen::MatrixXd> Forecast::regular_covariance(const std::vector<const StopInformation*>& stops) const {
  std::optional<Eigen::MatrixXd> information = with_stops(stops);
  if (!information) return std::nullopt;
  const int unknowns = 6 * layout_.cameras;
  information->diagonal().head(unknowns).array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> llt(*information);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd J = ml::camera_chart(state_, layout_);
  Eigen::MatrixXd joint = J * llt.solve(J.transpose());
  add_common_errors(Errors::kBesideTurningPoint, &joint);
  if (!joint.allFinite()) return std::nullopt;  // LLT lets NaN pass
  std::vector<Eigen::Index> rows;
  for (int c = 0; c < layout_.cameras; ++c)
    for (int axis = 0; knowledge_.has_pose[static_cast<std::size_t>(c)] && axis < 6; ++axis)
      rows.push_back(6 * c + axis);
  return Eigen::MatrixXd(joint(rows, rows));
}

std::vector<AxisSigmas> Forecast::sigmas(const std::vector<const StopInformation*>& stops, Errors errors) const {
  constexpr double kShare = 1e-4;  // of an open direction's largest part
  std::vector<AxisSigmas> result;
  const std::optional<Eigen::MatrixXd> information = with_stops(stops);
  const Eigen::MatrixXd J = ml::camera_chart(state_, layout_);
  for (int c = 0; c < layout_.cameras; ++c) {
    if (!knowledge_.has_pose[static_cast<std::size_t>(c)]) continue;
    result.emplace_back();
    if (!information) continue;
    const ml::GlobalCovariance globals = ml::invert_information(*information);
    const Eigen::MatrixXd rows = J.middleRows(6 * c, 6);
    Eigen::MatrixXd covariance = rows * globals.covariance * rows.transpose();
    add_common_errors(errors, &covariance);
    const Eigen::MatrixXd free = J * globals.free_directions;
    for (int axis = 0; axis < 6; ++axis) {
      bool open = false;
      for (Eigen::Index k = 0; k < free.cols(); ++k)
        open = open || std::abs(free(6 * c + axis, k)) > kShare * free.col(k).cwiseAbs().maxCoeff();
      const double variance = covariance(axis, axis);
      if (!open && std::isfinite(variance) && variance > 0.0)
        result.back()[static_cast<std::size_t>(axis)] = std::sqrt(variance);
    }
  }
  return result;
}

}  // namespace rigproof::suggest
