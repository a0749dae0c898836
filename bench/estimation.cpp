// How near the estimator comes to the Cramer-Rao bound: RMSE over bound per axis with its lower 99 % confidence
// limit, NEES, refusals and time, over many geometric runs.
//   bench_estimation [--trials 2000] [--stops 10,20,50,100] [--lambda 0,1,2,5,10] [--model per_increment|per_pose]
//                    [--drive random|steps] [--systematics] [--suspension] [--outliers] [--choose-model]
//                    [--estimate-sigmas] [--cameras N] [--seed 0]
#include <Eigen/Cholesky>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "calibration_truth.h"
#include "rigproof/calib/ml.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/geometric/geometric.h"

namespace {

using namespace rigproof;

struct Options {
  int trials = 200;
  std::uint64_t seed = 0;
  std::vector<double> stops = {10, 20, 50, 100};
  std::vector<double> lambdas = {0, 1, 10};
  bool per_pose = false, steps = false, systematics = false, suspension = false, outliers = false;
  bool choose_model = false, estimate_sigmas = false;
  int random_cameras = 0;
};

std::vector<double> numbers(const char* text) {
  std::vector<double> values;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) values.push_back(std::stod(item));
  return values;
}

Options parse(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    const auto value = [&]() -> const char* { return i + 1 < count ? arguments[++i] : ""; };
    if (name == "--trials")
      options.trials = std::atoi(value());
    else if (name == "--seed")
      options.seed = static_cast<std::uint64_t>(std::atoll(value()));
    else if (name == "--stops")
      options.stops = numbers(value());
    else if (name == "--lambda")
      options.lambdas = numbers(value());
    else if (name == "--model")
      options.per_pose = std::string(value()) == "per_pose";
    else if (name == "--drive")
      options.steps = std::string(value()) == "steps";
    else if (name == "--cameras")
      options.random_cameras = std::atoi(value());
    else if (name == "--systematics")
      options.systematics = true;
    else if (name == "--suspension")
      options.suspension = true;
    else if (name == "--outliers")
      options.outliers = true;
    else if (name == "--choose-model")
      options.choose_model = true;
    else if (name == "--estimate-sigmas")
      options.estimate_sigmas = true;
    else
      throw Error("unknown option " + name);
  }
  return options;
}

GeometricConfig configuration(const Options& options, int stops, double lambda, int trial) {
  GeometricConfig config;
  config.seed = options.seed + static_cast<std::uint64_t>(trial);
  if (options.random_cameras > 0) config.rig = random_rig(config.seed, options.random_cameras);
  config.stops = stops;
  config.lambda = lambda;
  config.drive = options.steps ? GeometricDrive::kSteps : GeometricDrive::kRandom;
  config.odometry_model = options.per_pose ? OdometryModel::kPerPose : OdometryModel::kPerIncrement;
  if (options.systematics) {
    config.odometry_scale = 1.02;
    config.odometry_yaw_factor = 1.05;
  }
  if (options.suspension) {
    config.suspension_height_sigma_m = 0.001;
    config.suspension_tilt_sigma_rad = deg_to_rad(0.05);
  }
  if (options.outliers) {
    config.corner_outlier_fraction = 0.02;
    config.odometry_outlier_fraction = 0.05;
    config.plane_outlier_fraction = 0.05;
  }
  config.declare_odometry_model = !options.choose_model;
  config.declare_odometry_sigmas = !options.estimate_sigmas;
  return config;
}

// Mean squared error and mean bound of one axis, with what is needed for a confidence limit.
struct AxisSum {
  double error2 = 0.0, error4 = 0.0, bound2 = 0.0;
  void add(double e2, double b2) {
    error2 += e2;
    error4 += e2 * e2;
    bound2 += b2;
  }
  double ratio() const { return std::sqrt(error2 / bound2); }
  // One-sided 99 % limit by the delta method on the mean of squared errors.
  double lower_limit(int trials) const {
    const double mean = error2 / trials, variance = error4 / trials - mean * mean;
    const double low = mean - 2.326 * std::sqrt(variance / trials);
    return std::sqrt(std::max(0.0, low) / (bound2 / trials));
  }
};

struct Cell {
  std::array<AxisSum, 6> robot, pair;
  int solved = 0, refused = 0, wrong_model = 0;
  double nees = 0.0, seconds = 0.0;
};

double nees(const MlEstimate& estimate, const Truth& truth) {
  const std::size_t n = truth.cameras.size();
  Eigen::VectorXd error(6 * static_cast<Eigen::Index>(n));
  for (std::size_t c = 0; c < n; ++c)
    error.segment<6>(6 * static_cast<Eigen::Index>(c)) =
        se3_log(estimate.state.T_robot_camera[c] * truth.cameras[c].T_robot_camera.inverse());
  const Eigen::MatrixXd covariance =
      to_left_perturbation(*estimate.result.joint_covariance, estimate.state.T_robot_camera);
  return error.dot(covariance.ldlt().solve(error));
}

void add_mean_over(std::array<AxisSum, 6>* sums, const std::vector<std::pair<Vector6d, Vector6d>>& transforms) {
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double e2 = 0.0, b2 = 0.0;
    for (const auto& [error, variance] : transforms) {
      e2 += error[static_cast<Eigen::Index>(axis)] * error[static_cast<Eigen::Index>(axis)];
      b2 += variance[static_cast<Eigen::Index>(axis)];
    }
    const double n = static_cast<double>(transforms.size());
    (*sums)[axis].add(e2 / n, b2 / n);
  }
}

// What is declared is what is true; --estimate-sigmas declares nothing.
MlOptions method_options(const Options& options, const GeometricConfig& config) {
  MlOptions method;
  if (options.estimate_sigmas) return method;
  method.suspension_height_sigma_m = config.suspension_height_sigma_m;
  method.suspension_tilt_sigma_rad = config.suspension_tilt_sigma_rad;
  method.estimate_corner_level = method.estimate_plane_level = false;
  return method;
}

void add_trial(const GeometricConfig& config, const MlOptions& options, Cell* cell) {
  const GeometricRun run = draw_geometric_run(config);
  const auto begin = std::chrono::steady_clock::now();
  const MlEstimate estimate = estimate_maximum_likelihood(run.observations, options);
  cell->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (estimate.result.status != ResultStatus::kSolved) {
    ++cell->refused;
    return;
  }
  ++cell->solved;
  if (estimate.odometry.model != config.odometry_model) ++cell->wrong_model;
  const CalibrationState truth = state_of(run.truth);
  const InformationBound bound = cramer_rao_bound(
      run.observations, truth, noise_of(run.truth, config.suspension_height_sigma_m, config.suspension_tilt_sigma_rad));
  std::vector<std::pair<Vector6d, Vector6d>> robot, pairs;
  for (std::size_t c = 0; c < truth.T_robot_camera.size(); ++c)
    robot.emplace_back(transform_error(estimate.state.T_robot_camera[c], truth.T_robot_camera[c]),
                       bound.camera_to_robot[c].diagonal());
  for (const InformationBound::Pair& pair : bound.camera_to_camera) {
    const std::size_t j = static_cast<std::size_t>(pair.parent), k = static_cast<std::size_t>(pair.child);
    const auto between = [j, k](const CalibrationState& s) {
      return s.T_robot_camera[j].inverse() * s.T_robot_camera[k];
    };
    pairs.emplace_back(transform_error(between(estimate.state), between(truth)), pair.covariance.diagonal());
  }
  add_mean_over(&cell->robot, robot);
  if (!pairs.empty()) add_mean_over(&cell->pair, pairs);
  cell->nees += nees(estimate, run.truth);
}

void print_row(const char* name, const std::array<AxisSum, 6>& sums, int trials, bool bound) {
  std::printf("  %-22s", name);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double mean = (bound ? sums[axis].bound2 : sums[axis].error2) / trials;
    std::printf(" %9.5f", axis < 3 ? 100.0 * std::sqrt(mean) : rad_to_deg(std::sqrt(mean)));
  }
  std::printf("\n");
}

void print_ratios(const char* name, const std::array<AxisSum, 6>& sums, int trials) {
  std::printf("  %-22s", name);
  for (const AxisSum& sum : sums) std::printf(" %4.2f>%4.2f", sum.ratio(), sum.lower_limit(trials));
  std::printf("\n");
}

void print_cell(int stops, double lambda, const Cell& cell) {
  std::printf("N %d, lambda %g: %d solved, %d refused", stops, lambda, cell.solved, cell.refused);
  if (cell.wrong_model > 0) std::printf(", odometry model wrong in %d", cell.wrong_model);
  if (cell.solved == 0) {
    std::printf("\n");
    return;
  }
  std::printf(", NEES %.2f, %.1f ms\n", cell.nees / cell.solved, 1e3 * cell.seconds / (cell.solved + cell.refused));
  std::printf("  %-22s %9s %9s %9s %9s %9s %9s\n", "", "tx [cm]", "ty", "tz", "rx [deg]", "ry", "rz");
  print_row("bound, robot", cell.robot, cell.solved, true);
  print_row("ml, robot", cell.robot, cell.solved, false);
  print_ratios("ratio > 99 % limit", cell.robot, cell.solved);
  print_row("bound, between", cell.pair, cell.solved, true);
  print_row("ml, between", cell.pair, cell.solved, false);
  print_ratios("ratio > 99 % limit", cell.pair, cell.solved);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const Options options = parse(count, arguments);
    for (const double stops : options.stops) {
      for (const double lambda : options.lambdas) {
        Cell cell;
        for (int trial = 0; trial < options.trials; ++trial) {
          const GeometricConfig config = configuration(options, static_cast<int>(stops), lambda, trial);
          add_trial(config, method_options(options, config), &cell);
        }
        print_cell(static_cast<int>(stops), lambda, cell);
      }
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code());
  }
  return 0;
}
