#include "odometry_track.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rigproof/core/rigid3.h"

namespace rigproof::detection {
namespace {

// Stamps nearer than this are the same.
constexpr double kSameStamp = 1e-6;

double path_between(const OdometrySample& a, const OdometrySample& b) {
  return std::hypot(b.x_m - a.x_m, b.y_m - a.y_m) +
         OdometryTrack::kTurnLever * std::abs(wrap_angle(b.yaw_rad - a.yaw_rad));
}

constexpr double kThinned_m = 1e-3, kThinned_rad = 1e-3;
constexpr double kTurns_rad = 0.05, kMoves_m = 1e-3;

Eigen::Vector3d pose_of(const Stop& stop) { return {stop.x_m, stop.y_m, stop.yaw_rad}; }
Rigid3 transform_of(const Eigen::Vector3d& pose) { return planar_pose(pose.x(), pose.y(), pose.z()); }

// Whether the arc from the first to the last pose passes all poses in between.
bool arc_meets(const std::vector<Eigen::Vector3d>& poses, std::size_t first, std::size_t last) {
  const Rigid3 T_first = transform_of(poses[first]);
  const Vector6d twist = se3_log(T_first.inverse() * transform_of(poses[last]));
  const Eigen::Vector2d chord = poses[last].head<2>() - poses[first].head<2>();
  const double turn = wrap_angle(poses[last].z() - poses[first].z());
  double share = 0.0;
  for (std::size_t i = first + 1; i < last; ++i) {
    // Where along the arc: by the way or, where it turns on the spot or much, by the turn; time does not matter.
    const Eigen::Vector2d passed = poses[i].head<2>() - poses[first].head<2>();
    double at = 0.0;
    if (chord.norm() > kMoves_m && std::abs(turn) < kTurns_rad)
      at = chord.dot(passed) / chord.squaredNorm();
    else if (turn != 0.0)
      at = wrap_angle(poses[i].z() - poses[first].z()) / turn;
    if (at < share - 1e-3 || at > 1.0 + 1e-3) return false;  // there and back
    share = std::max(share, at);
    const Rigid3 T = T_first * se3_exp(at * twist);
    if ((T.translation.head<2>() - poses[i].head<2>()).norm() > kThinned_m ||
        std::abs(wrap_angle(yaw_of(T) - poses[i].z())) > kThinned_rad)
      return false;
  }
  return true;
}

// The longest arc from a pose on that meets what it passes: found by doubling, then halving.
std::size_t end_of_arc(const std::vector<Eigen::Vector3d>& poses, std::size_t first) {
  std::size_t end = first + 1;
  for (std::size_t step = 1; step > 0;) {
    const bool meets = end + step < poses.size() && arc_meets(poses, first, end + step);
    if (meets) end += step;
    step = meets ? 2 * step : step / 2;
  }
  return end;
}

}  // namespace

OdometryTrack::OdometryTrack(const std::vector<OdometrySample>& samples, double max_gap_s, double nearest_s)
    : samples_(samples), odometer_m_(samples.size(), 0.0), max_gap_s_(max_gap_s), nearest_s_(nearest_s) {
  for (std::size_t i = 1; i < samples.size(); ++i)
    odometer_m_[i] = odometer_m_[i - 1] + path_between(samples[i - 1], samples[i]);
}

std::optional<OdometryReading> OdometryTrack::at(double stamp_s, Finding* why_not) const {
  if (samples_.empty()) {
    *why_not = Finding("odometry.none");
    return std::nullopt;
  }
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), stamp_s,
                                      [](const OdometrySample& sample, double t) { return sample.stamp_s < t; });
  const auto next = static_cast<std::size_t>(after - samples_.begin());
  const bool has_next = next<samples_.size(), has_previous = next> 0;
  const double to_next = has_next ? samples_[next].stamp_s - stamp_s : 1e300;
  const double to_previous = has_previous ? stamp_s - samples_[next - 1].stamp_s : 1e300;
  if (to_next <= kSameStamp) return sample(next);
  if (to_previous <= kSameStamp) return sample(next - 1);
  if (has_next && has_previous && to_next + to_previous <= max_gap_s_) return interpolated(next - 1, stamp_s);
  const std::size_t nearest = to_next < to_previous ? next : next - 1;
  if (std::min(to_next, to_previous) <= nearest_s_) {
    OdometryReading reading = sample(nearest);
    const std::size_t segment = std::min(nearest, samples_.size() < 2 ? 0 : samples_.size() - 2);
    if (samples_.size() > 1) reading.sigma_m = velocity(segment).head<2>().norm() * std::min(to_next, to_previous);
    return reading;
  }
  *why_not =
      has_next && has_previous
          ? Finding("odometry.gap", {{"gap_s", to_next + to_previous},
                                     {"from_s", samples_[next - 1].stamp_s},
                                     {"to_s", samples_[next].stamp_s}})
          : Finding("odometry.not_covering",
                    {{"stamp_s", stamp_s}, {"first_s", samples_.front().stamp_s}, {"last_s", samples_.back().stamp_s}});
  return std::nullopt;
}

std::vector<Eigen::Vector3d> OdometryTrack::way(const Stop& from, const Stop& to) const {
  std::vector<Eigen::Vector3d> poses = {pose_of(from)};
  const auto later = [](double stamp_s, const OdometrySample& sample) { return stamp_s < sample.stamp_s; };
  double last_s = from.stamp_s;
  for (auto sample = std::upper_bound(samples_.begin(), samples_.end(), from.stamp_s + kSameStamp, later);
       sample != samples_.end() && sample->stamp_s < to.stamp_s - kSameStamp; ++sample) {
    if (sample->stamp_s - last_s > max_gap_s_) return {};
    poses.emplace_back(sample->x_m, sample->y_m, sample->yaw_rad);
    last_s = sample->stamp_s;
  }
  if (to.stamp_s - last_s > max_gap_s_) return {};
  poses.push_back(pose_of(to));
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t end = end_of_arc(poses, 0); end + 1 < poses.size(); end = end_of_arc(poses, end))
    kept.push_back(poses[end]);
  return kept;
}

Eigen::Vector3d OdometryTrack::velocity_at(double stamp_s) const {
  constexpr double kStands_m_s = 2e-3, kStands_rad_s = 2e-3;
  const auto earlier = [](const OdometrySample& sample, double t) { return sample.stamp_s < t; };
  const auto later = [](double t, const OdometrySample& sample) { return t < sample.stamp_s; };
  const auto before = std::lower_bound(samples_.begin(), samples_.end(), stamp_s - kSameStamp, earlier);
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), stamp_s + kSameStamp, later);
  if (before == samples_.begin() || after == samples_.end()) return Eigen::Vector3d::Zero();
  const OdometrySample &a = *(before - 1), &b = *after;
  const double gap = b.stamp_s - a.stamp_s;
  if (gap > max_gap_s_) return Eigen::Vector3d::Zero();
  const Rigid3 T = planar_pose(a.x_m, a.y_m, a.yaw_rad).inverse() * planar_pose(b.x_m, b.y_m, b.yaw_rad);
  const Vector6d twist = se3_log(T) / gap;
  const Eigen::Vector3d velocity(twist[0], twist[1], twist[5]);
  const bool stands = velocity.head<2>().norm() < kStands_m_s && std::abs(velocity.z()) < kStands_rad_s;
  return stands ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : velocity;
}

Eigen::Vector3d OdometryTrack::acceleration_at(double stamp_s) const {
  constexpr double kReach_s = 0.06 + kSameStamp;
  constexpr Eigen::Index kLeast = 5;
  constexpr double kMost_m_s2 = 10.0, kMost_rad_s2 = 10.0;  // tyres grip up to about 1 g
  if (velocity_at(stamp_s).isZero(0.0)) return Eigen::Vector3d::Zero();
  const auto earlier = [](const OdometrySample& sample, double t) { return sample.stamp_s < t; };
  const auto first = std::lower_bound(samples_.begin(), samples_.end(), stamp_s - kReach_s, earlier);
  const auto end = std::lower_bound(first, samples_.end(), stamp_s + kReach_s, earlier);
  const auto count = static_cast<Eigen::Index>(end - first);
  if (count < kLeast) return Eigen::Vector3d::Zero();
  const OdometrySample& middle = *(first + count / 2);
  const Rigid3 T_middle = planar_pose(middle.x_m, middle.y_m, middle.yaw_rad);
  Eigen::MatrixXd by(count, 3), poses(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const OdometrySample& sample = *(first + i);
    const double t = sample.stamp_s - stamp_s;
    const Vector6d arc = se3_log(T_middle.inverse() * planar_pose(sample.x_m, sample.y_m, sample.yaw_rad));
    by.row(i) << 1.0, t, 0.5 * t * t;
    poses.row(i) << arc[0], arc[1], arc[5];
  }
  const Eigen::MatrixXd parabola = by.colPivHouseholderQr().solve(poses);
  const Eigen::Vector3d acceleration = parabola.row(2).transpose();
  const bool possible = acceleration.head<2>().norm() < kMost_m_s2 && std::abs(acceleration.z()) < kMost_rad_s2;
  return possible ? acceleration : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

OdometryReading OdometryTrack::sample(std::size_t index) const {
  const OdometrySample& s = samples_[index];
  return {s.x_m, s.y_m, s.yaw_rad, 0.0, odometer_m_[index]};
}

// Mean velocity between a sample and the next [m/s, m/s, rad/s].
Eigen::Vector3d OdometryTrack::velocity(std::size_t before) const {
  const OdometrySample &a = samples_[before], &b = samples_[before + 1];
  return Eigen::Vector3d(b.x_m - a.x_m, b.y_m - a.y_m, wrap_angle(b.yaw_rad - a.yaw_rad)) / (b.stamp_s - a.stamp_s);
}

OdometryReading OdometryTrack::interpolated(std::size_t before, double stamp_s) const {
  const OdometrySample &a = samples_[before], &b = samples_[before + 1];
  const double gap = b.stamp_s - a.stamp_s, u = (stamp_s - a.stamp_s) / gap;
  const Rigid3 T_a_b = planar_pose(a.x_m, a.y_m, a.yaw_rad).inverse() * planar_pose(b.x_m, b.y_m, b.yaw_rad);
  const Rigid3 T = planar_pose(a.x_m, a.y_m, a.yaw_rad) * se3_exp(u * se3_log(T_a_b));
  OdometryReading reading;
  reading.x_m = T.translation.x();
  reading.y_m = T.translation.y();
  reading.yaw_rad = a.yaw_rad + u * wrap_angle(b.yaw_rad - a.yaw_rad);
  reading.odometer_m = odometer_m_[before] + u * (odometer_m_[before + 1] - odometer_m_[before]);
  // The twist is not quite constant: its change to the neighbouring segments bounds the acceleration within this one,
  // and an acceleration c deviates by c u (1 - u) gap^2 / 2 from the constant twist.
  double change = 0.0;
  if (before > 0) change = std::max(change, (velocity(before) - velocity(before - 1)).head<2>().norm());
  if (before + 2 < samples_.size())
    change = std::max(change, (velocity(before + 1) - velocity(before)).head<2>().norm());
  reading.sigma_m = 0.5 * u * (1.0 - u) * change * gap;
  return reading;
}

}  // namespace rigproof::detection
