#include "rigproof/calib/estimate/odometry_rows.h"

#include <algorithm>
#include <cmath>

#include "rigproof/calib/estimate/residuals.h"
#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Whitened squares of three dimensions that noise reaches once in a billion.
constexpr double kWild = 45.0;

using Rows = std::vector<Eigen::Vector3d>;  // x, y [m], yaw [rad]

// What the odometry should say about the motion from one stop to another, less what it says, in sigmas.
struct Contradiction {
  Eigen::Vector3d residual;  // metres, radians
  Eigen::Vector3d whitened;
};

// The way to a stop from the one before the stop before.
Stop over_two(const Stop& middle, Stop to) {
  std::vector<Eigen::Vector3d> way = middle.way;
  way.emplace_back(middle.x_m, middle.y_m, middle.yaw_rad);
  way.insert(way.end(), to.way.begin(), to.way.end());
  to.way = std::move(way);
  return to;
}

// The stop `to`, with the way to it from the stop `from`, which is one or two before.
Stop end_of_way(const Observations& observations, std::size_t from, std::size_t to) {
  return to == from + 2 ? over_two(observations.stops[from + 1], observations.stops[to]) : observations.stops[to];
}

Contradiction along_way(const Observations& observations, const NoiseLevels& noise, const State& state,
                        std::size_t from, std::size_t to) {
  const Stop& start = observations.stops[from];
  const Stop end = end_of_way(observations, from, to);
  const OdometryWay way(start, end, observations.odometry_noise.rotation_centre_m);
  const Eigen::Vector3d residual = way_residual(state.poses[from], state.poses[to], state.odometry_errors(), way).value;
  return {residual, way_noise(way, noise, start, end).whitening * residual};
}

Contradiction contradiction_between(const Observations& observations, const NoiseLevels& noise, const State& state,
                                    std::size_t from, std::size_t to) {
  if (noise.law.along_way) return along_way(observations, noise, state, from, to);
  Eigen::Vector3d sigma(noise.odometry_xy_m, noise.odometry_xy_m, noise.odometry_yaw_rad);
  if (to > from + 1) {  // two motions, the second one turned by the first one's error
    const RobotPose &a = state.poses[from + 1], &b = state.poses[to];
    const double lever = noise.odometry_yaw_rad * std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
    sigma.head<2>().setConstant(std::sqrt(2.0 * noise.odometry_xy_m * noise.odometry_xy_m + lever * lever));
    sigma.z() *= std::sqrt(2.0);
  }
  const Eigen::Vector3d residual =
      increment_residual(state.poses[from], state.poses[to], state.odometry_errors(),
                         veering_increment(observations.stops[from], end_of_way(observations, from, to),
                                           observations.odometry_noise.rotation_centre_m))
          .value;
  return {residual, residual.cwiseQuotient(sigma)};
}

Eigen::Vector3d residual_at(const Observations& observations, const State& state, std::size_t i) {
  return pose_residual(state.poses[i], observations.stops[i], observations.odometry_noise.rotation_centre_m).value;
}

double square_of(const Eigen::Vector3d& residual, const NoiseLevels& noise) {
  const double xy = residual.head<2>().norm() / noise.odometry_xy_m, yaw = residual.z() / noise.odometry_yaw_rad;
  return xy * xy + yaw * yaw;
}

long views_at(const Observations& observations, int stop) {
  return std::count_if(observations.board_views.begin(), observations.board_views.end(),
                       [stop](const BoardView& view) { return view.stop == stop; });
}

WildRow wild_row(std::size_t stop, bool slip, const Eigen::Vector3d& residual) {
  return {static_cast<int>(stop), slip, residual.head<2>().norm(), std::abs(residual.z())};
}

std::vector<WildRow> wild_poses(const Observations& observations, const NoiseLevels& noise, const State& state) {
  std::vector<WildRow> rows;
  for (std::size_t i = 0; i < observations.stops.size(); ++i) {
    const Eigen::Vector3d residual = residual_at(observations, state, i);
    if (square_of(residual, noise) > kWild) rows.push_back(wild_row(i, false, residual));
  }
  return rows;
}

// Both motions of a stop are wrong but that past it is right: its row is wrong. Else the wheels slipped.
std::vector<WildRow> wild_increments(const Observations& observations, const NoiseLevels& noise, const State& state) {
  std::vector<WildRow> rows;
  const std::size_t n = observations.stops.size();
  const auto between = [&](std::size_t from, std::size_t to) {
    return contradiction_between(observations, noise, state, from, to);
  };
  const auto wild = [&](std::size_t from, std::size_t to) { return between(from, to).whitened.squaredNorm() > kWild; };
  for (std::size_t i = 1; i < n; ++i) {
    if (!wild(i - 1, i)) continue;
    const Eigen::Vector3d residual = between(i - 1, i).residual;
    const bool last = i + 1 == n, only_first = i == 1 && n > 2 && !wild(1, 2);
    if (!last && wild(i, i + 1) && !wild(i - 1, i + 1)) {
      rows.push_back(wild_row(i, false, residual));
      ++i;  // the motion away from it is explained
    } else {
      rows.push_back(wild_row(only_first ? 0 : i, !last && !only_first, residual));
    }
  }
  return rows;
}

// The odometry of a row that is read `share` of the way to a neighbour.
Stop read_between(const Stop& a, const Stop& b, double share) {
  Stop stop = a;
  stop.x_m += share * (b.x_m - a.x_m);
  stop.y_m += share * (b.y_m - a.y_m);
  stop.yaw_rad += share * wrap_angle(b.yaw_rad - a.yaw_rad);
  return stop;
}

}  // namespace

std::vector<WildRow> find_wild_rows(const Observations& observations, const NoiseLevels& noise, const State& state) {
  if (state.poses.size() != observations.stops.size()) return {};
  return noise.law.model == OdometryModel::kPerPose ? wild_poses(observations, noise, state)
                                                    : wild_increments(observations, noise, state);
}

Finding finding_of(const WildRow& row, const Observations& observations) {
  const FindingValues values = {{"stamp_s", observations.stops[static_cast<std::size_t>(row.stop)].stamp_s},
                                {"off_cm", 100.0 * row.off_m},
                                {"off_deg", rad_to_deg(row.off_rad)}};
  if (row.slip) return Finding("odometry.slip", values).with({{"from", row.stop - 1}, {"to", row.stop}}).at({row.stop});
  const bool only_frame = views_at(observations, row.stop) == 1;
  return Finding(only_frame ? "odometry.row_or_frame_contradicts" : "odometry.row_contradicts", values).at({row.stop});
}

bool StampShift::contradicts() const {
  constexpr double kMinDeviations = 5.0, kMinStops = 0.02;
  return deviations > kMinDeviations && std::abs(stops) > kMinStops;
}

StampShift estimate_stamp_shift(const Observations& observations, const NoiseLevels& noise, const State& state) {
  const CauchyLoss loss;
  const std::vector<Stop>& rows = observations.stops;
  const std::size_t n = rows.size();
  double slope = 0.0, information = 0.0;
  if (n < 4 || state.poses.size() != n) return {};
  // Where the robot drives from stop to stop, a row read early lies on the way, not between two stops.
  if (noise.law.along_way) return {};
  const bool increments = noise.law.model == OdometryModel::kPerIncrement;
  const Eigen::Vector2d& turns_about_m = observations.odometry_noise.rotation_centre_m;
  const Eigen::Vector3d inverse(1.0 / noise.odometry_xy_m, 1.0 / noise.odometry_xy_m, 1.0 / noise.odometry_yaw_rad);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (increments && i + 2 >= n) break;
    constexpr double kShare = 0.05;  // central difference on both sides of the row
    const auto read = [&](std::size_t k, double share) {
      return share > 0.0 ? read_between(rows[k], rows[k + 1], share) : read_between(rows[k], rows[k - 1], -share);
    };
    Eigen::Vector3d residual, change;
    if (increments) {
      residual = contradiction_between(observations, noise, state, i, i + 1).residual;
      change = measured_increment(read(i, kShare), read(i + 1, kShare), turns_about_m) -
               measured_increment(read(i, -kShare), read(i + 1, -kShare), turns_about_m);
    } else {
      residual = residual_at(observations, state, i);
      const auto point_at = [&](const Stop& row) {
        return odometry_of_point({row.x_m, row.y_m, row.yaw_rad}, turns_about_m);
      };
      change = point_at(read(i, kShare)) - point_at(read(i, -kShare));
    }
    residual = residual.cwiseProduct(inverse).eval();
    change = change.cwiseProduct(inverse).eval() / (2.0 * kShare);
    const double weight = loss.weight(residual.squaredNorm());
    // What is measured exceeds what the cameras say by stops * change.
    slope -= weight * change.dot(residual);
    information += weight * change.squaredNorm();
  }
  if (!(information > 0.0)) return {};
  return {slope / information, std::abs(slope) / std::sqrt(information)};
}

}  // namespace rigproof::ml
