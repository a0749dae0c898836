#include "rigproof/validate/bound.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "rigproof/calib/estimate/information.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/figures.h"
#include "rigproof/truth/stop_at.h"

namespace rigproof {
namespace {

std::optional<CalibrationState> state_at(const Observations& observations, const Truth& truth) {
  if (observations.boards() > truth.boards()) return std::nullopt;
  CalibrationState state;
  for (const RigCamera& camera : observations.cameras) {
    const auto same = [&camera](const TrueCamera& c) { return c.name == camera.name; };
    const auto match = std::find_if(truth.cameras.begin(), truth.cameras.end(), same);
    if (match == truth.cameras.end()) return std::nullopt;
    state.T_robot_camera.push_back(match->T_robot_camera);
    state.depth_scale.push_back(match->depth_scale.value_or(1.0));
  }
  for (const Stop& stop : observations.stops) {
    const std::optional<Rigid3> T_world_robot = robot_at(truth, stop.stamp_s);
    if (!T_world_robot) return std::nullopt;
    state.T_world_robot.push_back(*T_world_robot);
  }
  state.T_world_board = truth.T_world_board;
  for (int b = 1; b < observations.boards(); ++b) state.T_world_more_boards.push_back(truth.board_at(b).T_world_board);
  state.odometry_scale = truth.odometry_scale;
  state.odometry_yaw_factor = truth.odometry_yaw_factor;
  return state;
}

CalibrationNoise noise_at(const Truth& truth) {
  CalibrationNoise noise;
  if (truth.odometry_noise.model != OdometryModel::kUnknown) noise.law.model = truth.odometry_noise.model;
  noise.odometry_xy_m = truth.odometry_noise.sigma_xy_m.value_or(0.0);
  noise.odometry_yaw_rad = truth.odometry_noise.sigma_yaw_rad.value_or(0.0);
  return noise;
}

std::optional<InformationBound> information_at_truth(const Observations& observations, const Truth& truth) {
  const std::optional<CalibrationState> state = state_at(observations, truth);
  if (!state || observations.stops.empty()) return std::nullopt;
  return cramer_rao_bound(observations, *state, noise_at(truth));
}

// Whether directions that the data leave free move this axis of a transform.
bool is_open(const Eigen::MatrixXd& free, Eigen::Index row) {
  constexpr double kShare = 1e-4;  // of the direction's largest part
  for (Eigen::Index column = 0; column < free.cols(); ++column)
    if (std::abs(free(row, column)) > kShare * free.col(column).cwiseAbs().maxCoeff()) return true;
  return false;
}

std::vector<TransformBound> in_robot(const Observations& observations, const InformationBound& bound) {
  std::vector<TransformBound> bounds;
  for (std::size_t c = 0; c < bound.camera_to_robot.size(); ++c) {
    TransformBound& entry = bounds.emplace_back();
    entry.parent = "robot";
    entry.child = observations.cameras[c].name;
    entry.is_in_robot = true;
    for (int axis = 0; axis < 6; ++axis)
      if (!is_open(bound.free_directions, 6 * static_cast<Eigen::Index>(c) + axis))
        entry.sigma[static_cast<std::size_t>(axis)] = std::sqrt(bound.camera_to_robot[c](axis, axis));
  }
  return bounds;
}

// Between cameras, what all of them share cancels; where the joint information is singular nothing is claimed.
std::vector<TransformBound> between_cameras(const Observations& observations, const InformationBound& bound) {
  std::vector<TransformBound> bounds;
  for (const InformationBound::Pair& pair : bound.camera_to_camera) {
    TransformBound& entry = bounds.emplace_back();
    entry.parent = observations.cameras[static_cast<std::size_t>(pair.parent)].name;
    entry.child = observations.cameras[static_cast<std::size_t>(pair.child)].name;
    if (bound.free_directions.cols() > 0) continue;
    for (int axis = 0; axis < 6; ++axis)
      entry.sigma[static_cast<std::size_t>(axis)] = std::sqrt(pair.covariance(axis, axis));
  }
  return bounds;
}

AxisBounds largest(const std::vector<TransformBound>& bounds) {
  AxisBounds sigmas;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto is_absent = [axis](const TransformBound& bound) { return !bound.sigma[axis]; };
    if (std::any_of(bounds.begin(), bounds.end(), is_absent)) continue;
    for (const TransformBound& bound : bounds) sigmas[axis] = std::max(sigmas[axis].value_or(0.0), *bound.sigma[axis]);
  }
  return sigmas;
}

std::string sigma_text(const std::optional<double>& sigma, double unit) {
  if (!sigma) return "-";
  const double value = unit * *sigma;
  return figure(value, decimals_for_sigma(value));
}

// The largest of three axes.
std::optional<double> worst(const AxisBounds& bounds, std::size_t first) {
  std::optional<double> result;
  for (std::size_t axis = first; axis < first + 3; ++axis)
    if (bounds[axis]) result = std::max(result.value_or(0.0), *bounds[axis]);
  return result;
}

constexpr double kCentimetres = 100.0;
const double kDegrees = rad_to_deg(1.0);

}  // namespace

std::vector<TransformBound> transform_bounds(const Observations& observations, const Truth& truth) {
  const std::optional<InformationBound> bound = information_at_truth(observations, truth);
  if (!bound) return {};
  std::vector<TransformBound> bounds = in_robot(observations, *bound);
  for (TransformBound& pair : between_cameras(observations, *bound)) bounds.push_back(std::move(pair));
  return bounds;
}

std::optional<DataBound> largest_of(const std::vector<TransformBound>& bounds) {
  if (bounds.empty()) return std::nullopt;
  const auto is_in_robot = [](const TransformBound& bound) { return bound.is_in_robot; };
  std::vector<TransformBound> cameras, pairs;
  std::partition_copy(bounds.begin(), bounds.end(), std::back_inserter(cameras), std::back_inserter(pairs),
                      is_in_robot);
  return DataBound{largest(cameras), largest(pairs)};
}

std::optional<DataBound> data_bound(const Observations& observations, const Truth& truth) {
  return largest_of(transform_bounds(observations, truth));
}

std::string format_bound(const DataBound& bound) {
  static const std::array<const char*, 6> kAxes = {"tx", "ty", "tz", "rx", "ry", "rz"};
  std::string text = "The data allow";
  for (std::size_t axis = 0; axis < 6; ++axis) {
    text += std::string(" ") + kAxes[axis] + " " +
            sigma_text(bound.camera_to_robot[axis], axis < 3 ? kCentimetres : kDegrees);
    if (axis == 2) text += " cm,";
  }
  text += " deg (1 sigma)";
  const std::optional<double> distance = worst(bound.camera_to_camera, 0), angle = worst(bound.camera_to_camera, 3);
  if (distance && angle)
    text += "; between cameras " + sigma_text(distance, kCentimetres) + " cm, " + sigma_text(angle, kDegrees) + " deg";
  return text + ".\n";
}

}  // namespace rigproof
