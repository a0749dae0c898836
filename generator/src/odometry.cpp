#include "rigproof/generator/odometry.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/random.h"

namespace rigproof {
namespace {

// Share of the time between two stops that the robot stands at either end.
constexpr double kStandingShare = 0.2;

struct PlanarNoise {
  double x, y, yaw;
};

PlanarNoise draw(const OdometrySimulation& simulation, RandomStream random) {
  const double x = random.normal(0.0, simulation.sigma_xy_m);
  const double y = random.normal(0.0, simulation.sigma_xy_m);
  return {x, y, random.normal(0.0, simulation.sigma_yaw_rad)};
}

OdometrySample sample_of(double stamp_s, const Rigid3& T_odom_robot) {
  return {stamp_s, T_odom_robot.translation.x(), T_odom_robot.translation.y(), yaw_of(T_odom_robot)};
}

OdometrySample with_noise(OdometrySample sample, const PlanarNoise& noise) {
  sample.x_m += noise.x;
  sample.y_m += noise.y;
  sample.yaw_rad = wrap_angle(sample.yaw_rad + noise.yaw);
  return sample;
}

// The robot's pose on the ground plane, without suspension.
Rigid3 planar_part(const Rigid3& T) { return planar_pose(T.translation.x(), T.translation.y(), yaw_of(T)); }

Rigid3 measured_increment(const Rigid3& T_a_b, const OdometrySimulation& simulation, const PlanarNoise& noise) {
  return planar_pose(simulation.scale * T_a_b.translation.x() + noise.x,
                     simulation.scale * T_a_b.translation.y() + noise.y,
                     simulation.yaw_factor * yaw_of(T_a_b) + noise.yaw);
}

// Where the wheels say the robot stands at each stop, in the odometry frame.
std::vector<Rigid3> accumulate(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                               std::uint64_t seed) {
  std::vector<Rigid3> measured(stops.size());
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const Rigid3 T_a_b = planar_part(stops[i - 1].T_world_robot).inverse() * planar_part(stops[i].T_world_robot);
    const RandomStream random(seed, "odometry", static_cast<std::int64_t>(i));
    measured[i] = measured[i - 1] * measured_increment(T_a_b, simulation, draw(simulation, random));
  }
  return measured;
}

// Share of the way from one stop to the next, 0 to 1, at a share of the time; it starts and ends without a jerk.
double travelled(double time_share) {
  const double f = std::clamp((time_share - kStandingShare) / (1.0 - 2.0 * kStandingShare), 0.0, 1.0);
  return f * f * (3.0 - 2.0 * f);
}

Rigid3 on_arc(const Rigid3& T_odom_a, const Rigid3& T_odom_b, double share) {
  return T_odom_a * se3_exp(share * se3_log(T_odom_a.inverse() * T_odom_b));
}

}  // namespace

std::vector<OdometrySample> simulate_odometry(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                                              std::uint64_t seed) {
  const bool per_pose = simulation.model == OdometryModel::kPerPose;
  std::vector<Rigid3> at_stops;
  if (per_pose) {
    for (const TrueStop& stop : stops) at_stops.push_back(planar_part(stop.T_world_robot));
  } else {
    at_stops = accumulate(stops, simulation, seed);
  }
  std::vector<OdometrySample> samples;
  std::int64_t between = 0;  // counts the samples that belong to no stop
  for (std::size_t i = 0; i < stops.size(); ++i) {
    OdometrySample sample = sample_of(stops[i].stamp_s, at_stops[i]);
    if (per_pose) {
      const RandomStream random(seed, "odometry", static_cast<std::int64_t>(i));
      sample = with_noise(sample, draw(simulation, random));
    }
    samples.push_back(sample);
    if (simulation.rate_hz <= 0.0 || i + 1 == stops.size()) continue;
    const double period = stops[i + 1].stamp_s - stops[i].stamp_s;
    const int steps = static_cast<int>(std::ceil(period * simulation.rate_hz - 1e-9));
    for (int k = 1; k < steps; ++k, ++between) {
      const double share = k / (period * simulation.rate_hz);
      sample =
          sample_of(stops[i].stamp_s + k / simulation.rate_hz, on_arc(at_stops[i], at_stops[i + 1], travelled(share)));
      if (per_pose) sample = with_noise(sample, draw(simulation, RandomStream(seed, "odometry between", between)));
      samples.push_back(sample);
    }
  }
  return samples;
}

}  // namespace rigproof
