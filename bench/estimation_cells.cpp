#include "estimation_cells.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "calibration_truth.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof::bench {
namespace {

constexpr double kOneSided99 = 2.326;
constexpr double kTwoSided99 = 2.576;
constexpr double kSuspensionHeight_m = 0.001;
constexpr double kSuspensionTilt_deg = 0.05;

void add_mean_over(std::array<AxisSum, 6>* sums, const std::vector<std::pair<Vector6d, Vector6d>>& transforms) {
  if (transforms.empty()) return;
  const double n = static_cast<double>(transforms.size());
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    double e2 = 0.0, b2 = 0.0;
    for (const auto& [error, variance] : transforms) {
      e2 += error[axis] * error[axis] / n;
      b2 += variance[axis] / n;
    }
    (*sums)[static_cast<std::size_t>(axis)].add(e2, b2);
  }
}

// Errors and variances of the bound, camera to robot and camera to camera.
void add_errors(const std::vector<Rigid3>& estimate, const std::vector<Rigid3>& truth, const InformationBound& bound,
                Cell* cell) {
  std::vector<std::pair<Vector6d, Vector6d>> robot, pairs;
  for (std::size_t c = 0; c < truth.size(); ++c)
    robot.emplace_back(transform_error(estimate[c], truth[c]), bound.camera_to_robot[c].diagonal());
  for (const InformationBound::Pair& pair : bound.camera_to_camera) {
    const std::size_t j = static_cast<std::size_t>(pair.parent), k = static_cast<std::size_t>(pair.child);
    pairs.emplace_back(transform_error(estimate[j].inverse() * estimate[k], truth[j].inverse() * truth[k]),
                       pair.covariance.diagonal());
  }
  add_mean_over(&cell->robot, robot);
  add_mean_over(&cell->pair, pairs);
}

template <typename Sums, typename Visit>
void visit_numbers(Sums* sums, const char* name, const Visit& visit) {
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const std::string prefix = std::string(name) + std::to_string(axis);
    visit(prefix + ".error2", &(*sums)[axis].error2);
    visit(prefix + ".error4", &(*sums)[axis].error4);
    visit(prefix + ".bound2", &(*sums)[axis].bound2);
  }
}

// Every number of a cell, named and in order.
template <typename CellType, typename Visit>
void visit_cell(CellType* cell, const Visit& visit) {
  visit("trials", &cell->trials);
  visit("solved", &cell->solved);
  visit("refused", &cell->refused);
  visit("wrong_model", &cell->wrong_model);
  visit("nees", &cell->nees);
  visit("nees2", &cell->nees2);
  visit("seconds", &cell->seconds);
  visit_numbers(&cell->robot, "robot", visit);
  visit_numbers(&cell->pair, "pair", visit);
}

}  // namespace

std::string CellKey::file_name() const {
  return fmt::format("{}_n{}_lambda{:g}_seed{}.txt", sheet.name, stops, lambda, seed);
}

void AxisSum::add(double e2, double b2) {
  error2 += e2;
  error4 += e2 * e2;
  bound2 += b2;
}

double AxisSum::ratio() const { return std::sqrt(error2 / bound2); }

double AxisSum::limit(int trials, double sign) const {
  const double mean = error2 / trials, variance = std::max(0.0, error4 / trials - mean * mean);
  return std::sqrt(std::max(0.0, mean + sign * kOneSided99 * std::sqrt(variance / trials)) / (bound2 / trials));
}

double Cell::nees_limit() const {
  const double mean = mean_nees();
  return kTwoSided99 * std::sqrt(std::max(0.0, nees2 / solved - mean * mean) / solved);
}

double Cell::worst_lower_limit() const {
  double worst = 0.0;
  for (const AxisSum& sum : robot) worst = std::max(worst, sum.limit(solved, -1.0));
  for (const AxisSum& sum : pair)
    if (sum.bound2 > 0.0) worst = std::max(worst, sum.limit(solved, -1.0));
  return worst;
}

GeometricConfig configuration(const CellKey& key, int trial) {
  const Sheet& sheet = key.sheet;
  GeometricConfig config;
  config.seed = key.seed + static_cast<std::uint64_t>(trial);
  if (sheet.random_cameras > 0) config.rig = random_rig(config.seed, sheet.random_cameras);
  config.stops = key.stops;
  config.lambda = key.lambda;
  config.corner_sigma_px = sheet.corner_sigma_px;
  config.drive = sheet.steps ? GeometricDrive::kSteps : GeometricDrive::kRandom;
  config.odometry_model = sheet.per_pose ? OdometryModel::kPerPose : OdometryModel::kPerIncrement;
  if (sheet.systematics) {
    config.odometry_scale = 1.02;
    config.odometry_yaw_factor = 1.05;
  }
  if (sheet.suspension) {
    config.suspension_height_sigma_m = kSuspensionHeight_m;
    config.suspension_tilt_sigma_rad = deg_to_rad(kSuspensionTilt_deg);
  }
  if (sheet.outliers) {
    config.corner_outlier_fraction = 0.02;
    config.odometry_outlier_fraction = 0.05;
    config.plane_outlier_fraction = 0.05;
  }
  config.declare_odometry_model = !sheet.choose_model;
  config.declare_odometry_sigmas = !sheet.estimate_sigmas;
  return config;
}

MlOptions method_options(const CellKey& key, const GeometricConfig& config) {
  MlOptions method;
  if (key.sheet.known_odometry) method.priors.odometry_scale = method.priors.odometry_yaw_factor = 0.0;
  if (key.sheet.estimate_sigmas) return method;
  method.suspension_height_sigma_m = config.suspension_height_sigma_m;
  method.suspension_tilt_sigma_rad = config.suspension_tilt_sigma_rad;
  method.estimate_corner_level = method.estimate_plane_level = false;
  return method;
}

void add_trial(const CellKey& key, int trial, Cell* cell) {
  const GeometricConfig config = configuration(key, trial);
  const GeometricRun run = draw_geometric_run(config);
  const auto begin = std::chrono::steady_clock::now();
  MlEstimate estimate;
  if (key.sheet.method == "ml")
    estimate = estimate_maximum_likelihood(run.observations, method_options(key, config));
  else
    estimate.result = find_method(key.sheet.method).solve(run.observations);
  cell->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++cell->trials;
  if (estimate.result.status != ResultStatus::kSolved) {
    ++cell->refused;
    return;
  }
  ++cell->solved;
  if (key.sheet.choose_model && estimate.odometry.model != config.odometry_model) ++cell->wrong_model;
  const CalibrationState truth = state_of(run.truth);
  CalibrationNoise noise = noise_of(run.truth, config.suspension_height_sigma_m, config.suspension_tilt_sigma_rad);
  if (key.sheet.known_odometry) noise.priors.odometry_scale = noise.priors.odometry_yaw_factor = 0.0;
  const InformationBound bound = cramer_rao_bound(run.observations, truth, noise);
  std::vector<Rigid3> T_robot_camera;
  for (const EstimatedTransform& transform : estimate.result.camera_to_robot)
    T_robot_camera.push_back(transform.T_parent_child);
  add_errors(T_robot_camera, truth.T_robot_camera, bound, cell);
  if (!estimate.result.joint_covariance) return;
  const double value = nees(estimate.result, T_robot_camera, poses_of(run.truth));
  cell->nees += value;
  cell->nees2 += value * value;
}

ConvergenceTrial compare_starts(const CellKey& key, const GeometricConfig& config) {
  // Both stop within 1e-8 squared sigmas of the minimum; a mode of its own costs whole ones.
  constexpr double kSameCost = 1e-4;
  const GeometricRun run = draw_geometric_run(config);
  MlOptions options = method_options(key, config);
  const MlEstimate from_data = estimate_maximum_likelihood(run.observations, options);
  options.start = state_of(run.truth);
  const MlEstimate from_truth = estimate_maximum_likelihood(run.observations, options);
  ConvergenceTrial trial;
  trial.cost_from_data = from_data.cost;
  trial.cost_from_truth = from_truth.cost;
  trial.settled = from_data.converged && from_truth.converged;
  trial.same_optimum = from_data.cost <= from_truth.cost + kSameCost;
  return trial;
}

Cell load_cell(const std::filesystem::path& folder, const CellKey& key) {
  Cell cell;
  const std::filesystem::path file = folder / key.file_name();
  if (!std::filesystem::exists(file)) return cell;
  std::istringstream text(read_text_file(file));
  visit_cell(&cell, [&](const std::string& name, auto* value) {
    std::string found;
    if (!(text >> found >> *value) || found != name)
      throw Error(file.string() + ": " + name + " expected, \"" + found + "\" found; remove the file to start it anew");
  });
  return cell;
}

void save_cell(const std::filesystem::path& folder, const CellKey& key, const Cell& cell) {
  std::string text;
  visit_cell(&cell, [&text](const std::string& name, const auto* value) {
    text += name + " " + number_text(static_cast<double>(*value)) + "\n";
  });
  write_file_atomically(folder / key.file_name(), text);
}

}  // namespace rigproof::bench
