#include "told_odometry.h"

#include <map>
#include <string>

#include "driven.h"
#include "rigproof/core/conventions.h"
#include "rigproof/generator/odometry.h"
#include "sensing/resolve.h"

namespace rigproof {
namespace {

// Drawn once a run.
OdometrySimulation resolve_odometry(const OdometryConfig& config, const RobotModel& robot, std::uint64_t seed,
                                    std::map<std::string, double>* drawn) {
  RandomStream random(seed, "odometry systematics");
  OdometrySimulation simulation;
  simulation.model = config.model == "per_pose" ? OdometryModel::kPerPose : OdometryModel::kPerIncrement;
  simulation.sigma_xy_m = config.lambda * config.sigma_xy_cm / 100.0;
  simulation.sigma_yaw_rad = config.lambda * config.sigma_yaw_rad;
  simulation.scale = config.scale.sample(random);
  simulation.yaw_factor = config.yaw_factor.sample(random);
  simulation.rate_hz = config.rate_hz;
  if (config.model == "thrun") simulation.law = OdometryLaw::kThrun;
  simulation.thrun = {config.thrun.a1, config.thrun.a2, config.thrun.a3, config.thrun.a4};
  if (config.model != "wheels") return simulation;
  simulation.law = OdometryLaw::kWheels;
  const auto draw = [&](const char* name, const Distribution& distribution) {
    return (*drawn)[std::string("odometry.wheels.") + name] = distribution.sample(random);
  };
  WheelErrors& wheels = simulation.wheels;
  wheels.nominal_track_m = robot.track_m * robot.slip_factor;
  wheels.diameter_ratio = draw("diameter_ratio", config.wheels.diameter_ratio);
  wheels.track_ratio = draw("track_ratio", config.wheels.track_ratio);
  wheels.icr_x_m = draw("icr_x_m", config.wheels.icr_x_m);
  wheels.icr_asymmetry_m = draw("icr_asymmetry_m", config.wheels.icr_asymmetry_m);
  wheels.slip = 0.01 * config.wheels.slip_percent;
  if (robot.encoder_ticks_per_turn > 0.0)
    wheels.way_of_tick_m = 2.0 * kPi * robot.wheel_radius_m / robot.encoder_ticks_per_turn;
  return simulation;
}

OdometryNoise noise_of(const OdometrySimulation& simulation) {
  return {simulation.model, simulation.sigma_xy_m, simulation.sigma_yaw_rad};
}

std::uint64_t odometry_seed(const GenerateConfig& config) {
  return config.odometry.seed < 0 ? sensing_seed(config) : static_cast<std::uint64_t>(config.odometry.seed);
}

}  // namespace

void label_odometry(const std::vector<OdometrySample>& odometry, Truth* truth) {
  std::vector<OdometrySample> at_stops;
  for (const TrueStop& stop : truth->stops) at_stops.push_back(odometry_at(odometry, stop.stamp_s));
  const OdometryFit fit = fit_odometry(truth->stops, at_stops);
  truth->odometry_noise = {OdometryModel::kPerIncrement, fit.rms_xy_m, fit.rms_yaw_rad};
  truth->odometry_scale = fit.scale;
  truth->odometry_yaw_factor = fit.yaw_factor;
}

void tell_driven_axle(Rig* rig) {
  constexpr double kSigma_m = 0.005;
  rig->odometry_noise.rotation_centre_sigma_m = kSigma_m;
}

void tell_odometry(const GenerateConfig& config, const RobotModel& robot, Recording* recording, Truth* truth) {
  std::map<std::string, double> drawn;
  const std::uint64_t seed = odometry_seed(config);
  const OdometrySimulation odometry = resolve_odometry(config.odometry, robot, seed, &drawn);
  truth->drawn.insert(drawn.begin(), drawn.end());
  recording->odometry = simulate_odometry(truth->stops, odometry, seed);
  if (odometry.law == OdometryLaw::kPaper) {
    truth->odometry_noise = noise_of(odometry);
    truth->odometry_scale = odometry.scale;
    truth->odometry_yaw_factor = odometry.yaw_factor;
  } else {
    label_odometry(recording->odometry, truth);
  }
  if (config.odometry.declared) recording->rig.odometry_noise = truth->odometry_noise;
  // Drawn of the robot's frame; `wheels.icr_x_m` is an error that nobody knows of.
  if (odometry.rate_hz > 0.0) tell_driven_axle(&recording->rig);
}

}  // namespace rigproof
