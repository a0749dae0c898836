#include "rigproof/generator/odometry.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
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

// Thrun's noise is that of turns less than a quarter: a turn back weighs as much as a turn.
Rigid3 thrun_increment(const Rigid3& T_a_b, const ThrunNoise& a, RandomStream random) {
  const TurnDriveTurn exact = decompose(T_a_b);
  const double rot1 = exact.first_rad * exact.first_rad, trans = exact.way_m * exact.way_m;
  const double rot2 = exact.second_rad * exact.second_rad;
  TurnDriveTurn measured = exact;
  measured.first_rad += random.normal(0.0, std::sqrt(a.a1 * rot1 + a.a2 * trans));
  measured.way_m += random.normal(0.0, std::sqrt(a.a3 * trans + a.a4 * (rot1 + rot2)));
  measured.second_rad += random.normal(0.0, std::sqrt(a.a1 * rot2 + a.a2 * trans));
  return measured.motion();
}

// Encoders and the driver behind them. What a tick has cut off comes with the next one.
class SimulatedWheels {
 public:
  explicit SimulatedWheels(const WheelErrors& errors) : errors_(errors) {}

  Rigid3 increment(const Rigid3& T_a_b, RandomStream random) {
    // The centre of rotation turns on the spot where the robot's origin does not.
    const Rigid3 T_robot_centre = planar_pose(errors_.icr_x_m, 0.0, 0.0);
    const TurnDriveTurn true_motion = decompose(T_robot_centre.inverse() * T_a_b * T_robot_centre);
    Rigid3 measured = piece(0.0, true_motion.first_rad, random);
    measured = measured * piece(true_motion.way_m, 0.0, random);
    return measured * piece(0.0, true_motion.second_rad, random);
  }

 private:
  Rigid3 piece(double way_m, double turn_rad, RandomStream& random) {
    const double half_track = 0.5 * errors_.track_ratio * errors_.nominal_track_m;
    const double middle = way_m - turn_rad * errors_.icr_asymmetry_m;
    const double ratio = errors_.diameter_ratio;
    const double left = read(middle - turn_rad * half_track, 2.0 / (1.0 + ratio), random, &left_);
    const double right = read(middle + turn_rad * half_track, 2.0 * ratio / (1.0 + ratio), random, &right_);
    Vector6d twist = Vector6d::Zero();
    twist[0] = 0.5 * (left + right);
    twist[5] = (right - left) / errors_.nominal_track_m;
    return se3_exp(twist);
  }

  // A wheel that is larger turns less on the same way.
  double read(double way_m, double relative_diameter, RandomStream& random, double* total_m) const {
    const double slipped = way_m * (1.0 + random.normal(0.0, errors_.slip)) / relative_diameter;
    const double before = whole_ticks(*total_m);
    *total_m += slipped;
    return whole_ticks(*total_m) - before;
  }

  double whole_ticks(double way_m) const {
    return errors_.way_of_tick_m > 0.0 ? errors_.way_of_tick_m * std::floor(way_m / errors_.way_of_tick_m) : way_m;
  }

  const WheelErrors& errors_;
  double left_ = 0.0, right_ = 0.0;  ///< ways that the wheels have turned [m]
};

// Where the wheels say the robot stands at each stop, in the odometry frame.
std::vector<Rigid3> accumulate(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                               std::uint64_t seed) {
  std::vector<Rigid3> measured(stops.size());
  SimulatedWheels wheels(simulation.wheels);
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const Rigid3 T_a_b = planar_part(stops[i - 1].T_world_robot).inverse() * planar_part(stops[i].T_world_robot);
    const RandomStream random(seed, "odometry", static_cast<std::int64_t>(i));
    Rigid3 increment;
    switch (simulation.law) {
      case OdometryLaw::kPaper:
        increment = measured_increment(T_a_b, simulation, draw(simulation, random));
        break;
      case OdometryLaw::kThrun:
        increment = thrun_increment(T_a_b, simulation.thrun, random);
        break;
      case OdometryLaw::kWheels:
        increment = wheels.increment(T_a_b, random);
        break;
    }
    measured[i] = measured[i - 1] * increment;
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

Rigid3 TurnDriveTurn::motion() const { return planar_pose(0.0, 0.0, first_rad) * planar_pose(way_m, 0.0, second_rad); }

TurnDriveTurn decompose(const Rigid3& T_a_b) {
  const double x = T_a_b.translation.x(), y = T_a_b.translation.y(), turn = yaw_of(T_a_b);
  TurnDriveTurn result;
  result.way_m = std::hypot(x, y);
  // On the spot there is no direction to turn to first.
  if (result.way_m > 1e-9) result.first_rad = std::atan2(y, x);
  if (std::abs(result.first_rad) > 0.5 * kPi) {
    result.first_rad = wrap_angle(result.first_rad + kPi);
    result.way_m = -result.way_m;
  }
  result.second_rad = wrap_angle(turn - result.first_rad);
  return result;
}

std::vector<OdometrySample> simulate_odometry(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                                              std::uint64_t seed) {
  const bool per_pose = simulation.law == OdometryLaw::kPaper && simulation.model == OdometryModel::kPerPose;
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
