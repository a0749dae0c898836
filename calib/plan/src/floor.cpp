#include "floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace suggest {
namespace {

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

DriveArea stood_in(const std::vector<Rigid3>& T_world_robot, const Rigid3& T_world_first, double reach_m) {
  DriveArea area;
  for (const Rigid3& T : T_world_robot) {
    const Eigen::Vector3d p = T_world_first.inverse() * T.translation;
    area = {std::min(area.x_min_m, p.x()), std::max(area.x_max_m, p.x()), std::min(area.y_min_m, p.y()),
            std::max(area.y_max_m, p.y())};
  }
  return {area.x_min_m - reach_m, area.x_max_m + reach_m, area.y_min_m - reach_m, area.y_max_m + reach_m};
}

double whole_degrees(double angle_rad) { return deg_to_rad(std::round(rad_to_deg(angle_rad))); }

double without_small(double angle_rad, double min_turn_rad) {
  const double turn = whole_degrees(angle_rad);
  return std::abs(turn) < min_turn_rad ? 0.0 : turn;
}

}  // namespace

Place Place::of(const Rigid3& T) { return {T.translation.x(), T.translation.y(), yaw_of(T)}; }

Footprint footprint_of(const Board& board, const Rigid3& T_world_board) {
  Footprint footprint;
  for (const Eigen::Vector3d& corner : board.outline()) footprint.emplace_back((T_world_board * corner).head<2>());
  return footprint;
}

Floor::Floor(const SuggestOptions& options, const std::vector<Rigid3>& T_world_robot, std::vector<Footprint> boards)
    : clearance_m_(options.clearance_m), boards_(std::move(boards)) {
  if (!T_world_robot.empty()) T_world_first_ = Place::of(T_world_robot.front()).T_world_robot();
  area_ = options.area ? *options.area : stood_in(T_world_robot, T_world_first_, options.reach_m);
}

double Floor::distance_from_boards(double x_m, double y_m) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Footprint& board : boards_)
    for (std::size_t i = 0; i < board.size(); ++i)
      nearest = std::min(nearest, distance_to_segment({x_m, y_m}, board[i], board[(i + 1) % board.size()]));
  return nearest;
}

bool Floor::may_stand(const Place& place) const {
  const Eigen::Vector3d p = T_world_first_.inverse() * Eigen::Vector3d(place.x_m, place.y_m, 0.0);
  return p.x() >= area_.x_min_m && p.x() <= area_.x_max_m && p.y() >= area_.y_min_m && p.y() <= area_.y_max_m &&
         distance_from_boards(place.x_m, place.y_m) >= clearance_m_;
}

bool Floor::may_drive(const Place& from, const Place& to) const {
  constexpr int kSteps = 20;
  const double needed = std::min(clearance_m_, distance_from_boards(from.x_m, from.y_m));
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const double x = from.x_m + share * (to.x_m - from.x_m), y = from.y_m + share * (to.y_m - from.y_m);
    if (distance_from_boards(x, y) < needed - 1e-9) return false;
  }
  return true;
}

Place Place::turned_to(double heading_rad, const Eigen::Vector2d& about_m) const {
  const Eigen::Vector3d point = odometry_of_point({x_m, y_m, yaw_rad}, about_m);
  const Eigen::Vector3d origin = odometry_of_point({point.x(), point.y(), heading_rad}, -about_m);
  return {origin.x(), origin.y(), wrap_angle(heading_rad)};
}

DriveCommand command_between(const Place& from, const Place& to, double min_turn_rad, const Eigen::Vector2d& about_m) {
  constexpr double kNoDrive_m = 0.015;
  const Eigen::Vector3d start = odometry_of_point({from.x_m, from.y_m, from.yaw_rad}, about_m);
  const Eigen::Vector3d end = odometry_of_point({to.x_m, to.y_m, to.yaw_rad}, about_m);
  const double dx = end.x() - start.x(), dy = end.y() - start.y(), distance = std::hypot(dx, dy);
  const double turn = wrap_angle(to.yaw_rad - from.yaw_rad);
  if (distance < kNoDrive_m) return {without_small(turn, min_turn_rad), 0.0, 0.0, about_m};
  DriveCommand best;
  double least = std::numeric_limits<double>::infinity();
  for (const double sense : {1.0, -1.0}) {
    const double before = without_small(wrap_angle(std::atan2(sense * dy, sense * dx) - from.yaw_rad), min_turn_rad);
    const double after = without_small(wrap_angle(turn - before), min_turn_rad);
    const double turning = std::abs(before) + std::abs(after);
    if (turning >= least) continue;
    least = turning;
    best = {before, sense * std::round(100.0 * distance) / 100.0, after, about_m};
  }
  return best;
}

}  // namespace suggest

Rigid3 DriveCommand::motion() const {
  const Rigid3 T_robot_point = planar_pose(about_m.x(), about_m.y(), 0.0);
  return T_robot_point * planar_pose(0.0, 0.0, turn_before_rad) * planar_pose(distance_m, 0.0, turn_after_rad) *
         T_robot_point.inverse();
}

std::string DriveCommand::text() const {
  std::vector<std::string> parts;
  const auto add_turn = [&parts](double angle_rad) {
    if (angle_rad == 0.0) return;
    parts.push_back("turn " + fixed_text(rad_to_deg(std::abs(angle_rad)), 0) + " deg " +
                    (angle_rad > 0.0 ? "left" : "right"));
  };
  add_turn(turn_before_rad);
  if (distance_m != 0.0)
    parts.push_back(std::string(distance_m > 0.0 ? "drive " : "back up ") + fixed_text(std::abs(distance_m), 2) + " m");
  add_turn(turn_after_rad);
  if (distance_m == 0.0 && !parts.empty()) parts.back() += " on the spot";
  return parts.empty() ? "stay" : joined(parts);
}

}  // namespace rigproof
