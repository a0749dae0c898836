#include "rigproof/calib/estimate/odometry_way.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Noise that even a short way has: starting and stopping count like this much of way and turn.
constexpr double kLeastWay_m = 0.02, kLeastTurn_rad = 0.02;

// (sin t / t, (1 - cos t) / t): an arc of unit length that turns by t ends there.
Eigen::Vector2d unit_arc(double turn) {
  if (std::abs(turn) < 1e-4) return {1.0 - turn * turn / 6.0, 0.5 * turn};
  return {std::sin(turn) / turn, (1.0 - std::cos(turn)) / turn};
}

Eigen::Vector2d unit_arc_by_turn(double turn) {
  if (std::abs(turn) < 1e-4) return {-turn / 3.0, 0.5 - turn * turn / 8.0};
  return {(std::cos(turn) - unit_arc(turn).x()) / turn, (std::sin(turn) - unit_arc(turn).y()) / turn};
}

// The complex numbers' product: both turn and stretch.
Eigen::Vector2d product(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {a.x() * b.x() - a.y() * b.y(), a.x() * b.y() + a.y() * b.x()};
}

Eigen::Vector2d quarter_turn(const Eigen::Vector2d& a) { return {-a.y(), a.x()}; }

}  // namespace

OdometryWay::OdometryWay(const Stop& from, const Stop& to, const Eigen::Vector2d& point_m) : point_m_(point_m) {
  Eigen::Vector3d last = odometry_of_point({from.x_m, from.y_m, from.yaw_rad}, point_m);
  const auto add = [&](const Eigen::Vector3d& of_origin) {
    const Eigen::Vector3d pose = odometry_of_point(of_origin, point_m);
    const Eigen::Vector2d step = Eigen::Rotation2Dd(-last.z()) * Eigen::Vector2d(pose.head<2>() - last.head<2>());
    const double turn = wrap_angle(pose.z() - last.z());
    const Eigen::Vector2d arc = unit_arc(turn);
    arcs_.push_back({product(step, {arc.x(), -arc.y()}) / arc.squaredNorm(), turn});
    length_m_ += arcs_.back().way.norm();
    last = pose;
  };
  for (const Eigen::Vector3d& pose : to.way) add(pose);
  add({to.x_m, to.y_m, to.yaw_rad});
  add_noise();
}

OdometryWay::Motion OdometryWay::motion(double yaw_factor, double veer) const {
  Motion motion{Eigen::Vector3d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector3d::Zero()};
  Eigen::Vector2d position = Eigen::Vector2d::Zero(), by_inverse = position, by_veer = position;
  const double inverse = 1.0 / yaw_factor;
  double forward = 0.0;
  for (const Arc& arc : arcs_) {
    const double before = motion.value.z(), turned = arc.turn - veer * arc.way.x();  // measured, without the veer
    const Eigen::Vector2d heading(std::cos(inverse * before), std::sin(inverse * before));
    const double turn = inverse * turned;
    const Eigen::Vector2d step = product(heading, product(arc.way, unit_arc(turn)));
    const Eigen::Vector2d step_by_turn = product(heading, product(arc.way, unit_arc_by_turn(turn)));
    position += step;
    by_inverse += before * quarter_turn(step) + turned * step_by_turn;
    by_veer -= inverse * (forward * quarter_turn(step) + arc.way.x() * step_by_turn);
    motion.value.z() += turned;
    forward += arc.way.x();
  }
  motion.value.head<2>() = position;
  motion.xy_by_yaw_factor = -inverse * inverse * by_inverse;
  motion.by_veer << by_veer, -forward;
  return motion;
}

// With the way as it was measured: the noise's shape needs no more.
void OdometryWay::add_noise() {
  const Eigen::Vector2d end = motion(1.0).value.head<2>();
  translation_ = (length_m_ + kLeastWay_m) * Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal();
  turning_.setZero();
  straying_.setZero();
  const auto add = [&](const Eigen::Vector2d& at, double turn, double way) {
    const Eigen::Vector2d lever = quarter_turn(end - at);
    const Eigen::Vector3d effect(lever.x(), lever.y(), 1.0);
    const Eigen::Matrix3d square = effect * effect.transpose();
    turning_ += turn * square;
    straying_ += way * square;
  };
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double yaw = 0.0;
  add(position, 0.5 * kLeastTurn_rad, 0.0);
  for (const Arc& arc : arcs_) {
    const Eigen::Vector2d heading(std::cos(yaw), std::sin(yaw));
    const Eigen::Vector2d step = product(heading, product(arc.way, unit_arc(arc.turn)));
    add(position + 0.5 * step, std::abs(arc.turn), arc.way.norm());
    position += step;
    yaw += arc.turn;
  }
  add(position, 0.5 * kLeastTurn_rad, 0.0);
}

WayNoise way_noise(const OdometryWay& way, const NoiseLevels& levels, const Stop& from, const Stop& to) {
  const double xy = levels.odometry_xy_m, yaw = levels.odometry_yaw_rad;
  const Eigen::Matrix3d heading = yaw * yaw * way.noise_of_heading(levels.law);
  Eigen::Matrix3d covariance = xy * xy * way.noise_of_translation() + heading;
  for (const Stop* stop : {&from, &to})
    covariance.topLeftCorner<2, 2>().diagonal().array() += stop->interpolation_sigma_m * stop->interpolation_sigma_m;
  const Eigen::Matrix3d L = covariance.llt().matrixL();
  WayNoise noise;
  noise.whitening = L.inverse();
  noise.heading = noise.whitening * heading * noise.whitening.transpose();
  return noise;
}

NoiseLevels per_increment(const NoiseLevels& along_way, const Observations& observations) {
  NoiseLevels levels = along_way;
  levels.law.along_way = false;
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  const std::size_t n = observations.stops.size();
  for (std::size_t i = 1; i < n; ++i) {
    const OdometryWay way(observations.stops[i - 1], observations.stops[i],
                          observations.odometry_noise.rotation_centre_m);
    variance +=
        along_way.odometry_xy_m * along_way.odometry_xy_m * way.noise_of_translation().diagonal() +
        along_way.odometry_yaw_rad * along_way.odometry_yaw_rad * way.noise_of_heading(along_way.law).diagonal();
  }
  if (n < 2) return levels;
  variance /= static_cast<double>(n - 1);
  levels.odometry_xy_m = std::sqrt(0.5 * (variance.x() + variance.y()));
  levels.odometry_yaw_rad = std::sqrt(variance.z());
  return levels;
}

}  // namespace rigproof::ml
