#include "rigproof/generator/route.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {
namespace {

// How far apart a way is probed; obstacles are wider.
constexpr double kProbeStep_m = 0.06;
constexpr double kProbeTurn_rad = 0.12;
// A robot whose middle is amid a cell can turn there by all angles if it is free at these many headings.
constexpr int kHeadings = 12;
constexpr double kCell_m = 0.2;
// Straight pieces by which a robot leaves a tight place, and reaches one, along its heading.
constexpr std::array<double, 9> kAlong_m = {0.0, -0.6, 0.6, -1.0, 1.0, -1.5, 1.5, -2.2, 2.2};
// Ways around obstacles that are looked for before giving up.
constexpr int kMostSearches = 12;

double signed_turn(double from_rad, double to_rad) { return wrap_angle(to_rad - from_rad); }

}  // namespace

Eigen::Vector2d FloorPose::ahead(double distance_m) const {
  return position + distance_m * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
}

RoutePlanner::RoutePlanner(const FloorArea& area, Obstacle obstacle) : area_(area), obstacle_(std::move(obstacle)) {}

bool RoutePlanner::is_free(const FloorPose& pose) {
  const Eigen::Vector2d& p = pose.position;
  if (p.x() < area_.x_min || p.x() > area_.x_max || p.y() < area_.y_min || p.y() > area_.y_max) {
    last_obstacle_ = "the edge of the drivable area";
    return false;
  }
  const std::string name = obstacle_(pose);
  if (!name.empty()) last_obstacle_ = name;
  return name.empty();
}

bool RoutePlanner::can_turn(const FloorPose& pose, double turn_rad) {
  const int steps = static_cast<int>(std::ceil(std::abs(turn_rad) / kProbeTurn_rad));
  for (int i = 1; i <= steps; ++i)
    if (!is_free({pose.position, pose.yaw_rad + turn_rad * i / steps})) return false;
  return true;
}

bool RoutePlanner::can_drive(const FloorPose& from, double distance_m) {
  const int steps = static_cast<int>(std::ceil(std::abs(distance_m) / kProbeStep_m));
  for (int i = 1; i <= steps; ++i)
    if (!is_free({from.ahead(distance_m * i / steps), from.yaw_rad})) return false;
  return true;
}

bool RoutePlanner::can_turn_around(const Eigen::Vector2d& place) {
  for (int i = 0; i < kHeadings; ++i)
    if (!is_free({place, 2.0 * kPi * i / kHeadings})) return false;
  return true;
}

// The shorter way round, else the longer one.
bool RoutePlanner::append_turn(Route* route, FloorPose* pose, double yaw_rad) {
  const double turn = signed_turn(pose->yaw_rad, yaw_rad);
  for (const double way : {turn, turn - std::copysign(2.0 * kPi, turn)}) {
    if (!can_turn(*pose, way)) continue;
    pose->yaw_rad = yaw_rad;
    route->push_back({RouteLeg::Kind::kTurn, *pose, way, false});
    return true;
  }
  return false;
}

bool RoutePlanner::append_straight(Route* route, FloorPose* pose, const Eigen::Vector2d& to, bool backwards) {
  const double distance = (to - pose->position).norm();
  if (!can_drive(*pose, backwards ? -distance : distance)) return false;
  pose->position = to;
  route->push_back({RouteLeg::Kind::kStraight, *pose, 0.0, backwards});
  return true;
}

std::optional<Route> RoutePlanner::turn_and_drive(const FloorPose& start, const Eigen::Vector2d& to, bool backwards) {
  Route route;
  FloorPose pose = start;
  const Eigen::Vector2d d = to - start.position;
  if (d.norm() < 1e-3) return route;
  const double heading = std::atan2(d.y(), d.x()) + (backwards ? kPi : 0.0);
  if (!append_turn(&route, &pose, wrap_angle(heading)) || !append_straight(&route, &pose, to, backwards))
    return std::nullopt;
  return route;
}

std::optional<Route> RoutePlanner::direct(const FloorPose& start, const FloorPose& goal, bool backwards) {
  std::optional<Route> route = turn_and_drive(start, goal.position, backwards);
  if (!route) return std::nullopt;
  FloorPose pose = route->empty() ? start : route->back().end;
  if (!append_turn(&*route, &pose, goal.yaw_rad)) return std::nullopt;
  return route;
}

// Straight out along the start's heading, a direct way, straight in along the goal's heading.
std::optional<Route> RoutePlanner::between(const FloorPose& start, const FloorPose& goal, double out_m, double in_m,
                                           bool backwards) {
  Route route;
  FloorPose pose = start;
  if (out_m != 0.0 && !append_straight(&route, &pose, start.ahead(out_m), out_m < 0.0)) return std::nullopt;
  const FloorPose before{goal.ahead(in_m), goal.yaw_rad};
  const std::optional<Route> middle = direct(pose, before, backwards);
  if (!middle) return std::nullopt;
  route.insert(route.end(), middle->begin(), middle->end());
  pose = before;
  if (in_m != 0.0 && !append_straight(&route, &pose, goal.position, in_m > 0.0)) return std::nullopt;
  return route;
}

// Cells where the robot can turn by all angles, joined by straight pieces.
std::vector<Eigen::Vector2d> RoutePlanner::grid_path(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  using Cell = std::pair<int, int>;
  const auto cell_of = [this](const Eigen::Vector2d& p) {
    return Cell(static_cast<int>(std::lround((p.x() - area_.x_min) / kCell_m)),
                static_cast<int>(std::lround((p.y() - area_.y_min) / kCell_m)));
  };
  const auto place_of = [this](const Cell& cell) {
    return Eigen::Vector2d(area_.x_min + kCell_m * cell.first, area_.y_min + kCell_m * cell.second);
  };
  const auto free = [&](const Cell& cell) {
    const auto [it, is_new] = turn_around_.try_emplace(cell, false);
    if (is_new) it->second = can_turn_around(place_of(cell));
    return it->second;
  };
  const Cell first = cell_of(from), last = cell_of(to);
  if (!free(first) || !free(last)) return {};
  std::map<Cell, double> cost{{first, 0.0}};
  std::map<Cell, Cell> parent;
  const auto rest = [&](const Cell& cell) { return std::hypot(cell.first - last.first, cell.second - last.second); };
  using Entry = std::pair<double, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  open.push({rest(first), first});
  while (!open.empty()) {
    const auto [estimate, cell] = open.top();
    open.pop();
    if (cell == last) break;
    if (estimate > cost[cell] + rest(cell) + 1e-9) continue;
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell next(cell.first + dx, cell.second + dy);
        const double through = cost[cell] + std::hypot(dx, dy);
        const auto known = cost.find(next);
        if ((known != cost.end() && known->second <= through) || !free(next)) continue;
        cost[next] = through;
        parent[next] = cell;
        open.push({through + rest(next), next});
      }
  }
  if (first != last && parent.find(last) == parent.end()) return {};
  std::vector<Eigen::Vector2d> path{to};
  for (Cell cell = last; cell != first; cell = parent[cell]) path.push_back(place_of(cell));
  path.push_back(from);
  std::reverse(path.begin(), path.end());
  return path;
}

std::optional<Route> RoutePlanner::around(const FloorPose& start, const FloorPose& goal, double out_m, double in_m) {
  const FloorPose before{goal.ahead(in_m), goal.yaw_rad};
  const std::vector<Eigen::Vector2d> path = grid_path(start.ahead(out_m), before.position);
  if (path.empty()) return std::nullopt;
  Route route;
  FloorPose pose = start;
  if (out_m != 0.0 && !append_straight(&route, &pose, start.ahead(out_m), out_m < 0.0)) return std::nullopt;
  for (std::size_t i = 0; i + 1 < path.size();) {
    std::size_t next = path.size() - 1;
    std::optional<Route> piece;
    for (; next > i && !(piece = turn_and_drive(pose, path[next], false)); --next) {
    }
    if (!piece) return std::nullopt;
    route.insert(route.end(), piece->begin(), piece->end());
    if (!piece->empty()) pose = piece->back().end;
    i = next;
  }
  if (!append_turn(&route, &pose, goal.yaw_rad)) return std::nullopt;
  if (in_m != 0.0 && !append_straight(&route, &pose, goal.position, in_m > 0.0)) return std::nullopt;
  return route;
}

std::optional<Route> RoutePlanner::route(const FloorPose& start, const FloorPose& goal, int number, bool straight_in) {
  last_obstacle_.clear();
  if (!is_free(goal)) return std::nullopt;
  const Eigen::Vector2d d = goal.position - start.position;
  const double heading = std::atan2(d.y(), d.x());
  const bool backwards_first = std::abs(signed_turn(start.yaw_rad, heading)) > 0.5 * kPi;
  struct Pair {
    double out_m, in_m;
  };
  std::vector<Pair> pairs;
  for (const double out_m : kAlong_m)
    for (const double in_m : kAlong_m) pairs.push_back({out_m, in_m});
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
    if (straight_in && (a.in_m != 0.0) != (b.in_m != 0.0)) return a.in_m != 0.0;
    return std::abs(a.out_m) + std::abs(a.in_m) < std::abs(b.out_m) + std::abs(b.in_m);
  });
  std::string first_obstacle;  // on the most natural way
  for (const Pair& pair : pairs) {
    for (const bool backwards : {backwards_first, !backwards_first}) {
      std::optional<Route> found = between(start, goal, pair.out_m, pair.in_m, backwards);
      if (found && number-- == 0) return found;
      if (first_obstacle.empty()) first_obstacle = last_obstacle_;
    }
  }
  int searches = 0;
  for (const Pair& pair : pairs) {
    if (searches >= kMostSearches) break;
    if (!can_turn_around(start.ahead(pair.out_m)) || !can_turn_around(goal.ahead(pair.in_m))) continue;
    ++searches;
    std::optional<Route> found = around(start, goal, pair.out_m, pair.in_m);
    if (found && number-- == 0) return found;
  }
  if (!first_obstacle.empty()) last_obstacle_ = first_obstacle;
  return std::nullopt;
}

}  // namespace rigproof
