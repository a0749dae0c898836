#include "rigproof/generator/viewpoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// Headings that are tried at one place before another place is drawn.
constexpr int kHeadingsPerPlace = 8;
// Places that are drawn in the hope for one from which all cameras see the board.
constexpr int kPlacesForAllCameras = 25;
// How many of the stops that were drawn next the drive may choose from.
constexpr std::size_t kDriveWindow = 400;

enum Rejection : std::size_t { kOutside, kCutOff, kOblique, kCollision, kHidden, kRejections };

constexpr std::array<const char*, kRejections> kRejectionText = {
    "lie outside of the scene's drivable area", "do not have the whole board in enough images",
    "see the board at too flat an angle", "touch something", "have the board hidden behind something"};
constexpr std::array<const char*, kRejections> kRemedy = {
    "change viewpoints.distance_m or bearing_deg, or place the board elsewhere",
    "change viewpoints.distance_m or heading_deg, or lower min_cameras or margin_px",
    "narrow viewpoints.bearing_deg or raise max_obliquity_deg", "change viewpoints.distance_m or bearing_deg",
    "change viewpoints.bearing_deg, or place the board elsewhere"};

struct Tally {
  std::array<std::size_t, kRejections> rejected{};
  std::size_t candidates = 0;

  // "83 % lie outside of ..., 12 % touch something".
  std::string text() const {
    std::array<std::size_t, kRejections> order{};
    for (std::size_t i = 0; i < kRejections; ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return rejected[a] > rejected[b]; });
    std::string text;
    for (const std::size_t i : order) {
      if (rejected[i] == 0) continue;
      text += (text.empty() ? "" : ", ") + std::to_string((100 * rejected[i] + candidates / 2) / candidates) + " % " +
              kRejectionText[i];
    }
    return text;
  }

  const char* remedy() const {
    return kRemedy[static_cast<std::size_t>(std::max_element(rejected.begin(), rejected.end()) - rejected.begin())];
  }
};

class Planner {
 public:
  Planner(const ViewpointConfig& config, const ViewpointSubject& subject, ViewpointWorld& world)
      : config_(config), subject_(subject), world_(world), area_(world.drivable_area()) {
    const Eigen::Vector3d outward = -(subject.T_scene_board.rotation * Eigen::Vector3d::UnitZ());
    outward_ = outward;
    facing_rad_ = std::atan2(outward.y(), outward.x());
    centre_ = subject.T_scene_board * subject.board.centre();
    for (const Eigen::Vector3d& corner : subject.board.outline()) {
      const Eigen::Vector3d from_centre = corner - subject.board.centre();
      const Eigen::Vector3d border(std::copysign(subject.board_margin_m, from_centre.x()),
                                   std::copysign(subject.board_margin_m, from_centre.y()), 0.0);
      outline_.push_back(subject.T_scene_board * (corner + border));
      // Rays end a little inside of the sheet, where they cannot miss it.
      sight_points_.push_back(subject.T_scene_board * (subject.board.centre() + 0.98 * from_centre));
    }
    sight_points_.push_back(centre_);
  }

  Viewpoint place(double distance_m, double bearing_rad, double heading_rad) const {
    const double direction = facing_rad_ + bearing_rad;
    return at(centre_.x() + distance_m * std::cos(direction), centre_.y() + distance_m * std::sin(direction),
              direction + kPi + heading_rad);
  }

  Viewpoint at(double x_m, double y_m, double yaw_rad) const {
    Viewpoint stop;
    stop.x_m = x_m;
    stop.y_m = y_m;
    stop.yaw_rad = wrap_angle(yaw_rad);
    const double dx = x_m - centre_.x(), dy = y_m - centre_.y();
    stop.distance_m = std::hypot(dx, dy);
    stop.bearing_rad = wrap_angle(std::atan2(dy, dx) - facing_rad_);
    return stop;
  }

  // Below the board's centre, x towards its viewers.
  Rigid3 board_on_floor() const { return planar_pose(centre_.x(), centre_.y(), facing_rad_); }

  bool inside(const Viewpoint& stop) const {
    return stop.x_m >= area_.x_min && stop.x_m <= area_.x_max && stop.y_m >= area_.y_min && stop.y_m <= area_.y_max;
  }

  // Fills in what the cameras see. The first constraint that leaves fewer than `needed` cameras is the answer.
  std::optional<Rejection> look(int needed, Viewpoint* stop) {
    const Rigid3 T_scene_robot = stop->T_scene_robot();
    int whole = 0, steep = 0;
    std::vector<Eigen::Vector3d> origins;
    for (const WorldCamera& camera : subject_.cameras) {
      const Rigid3 T_scene_camera = T_scene_robot * camera.T_robot_camera;
      if (!has_whole_board(camera.camera, T_scene_camera)) continue;
      ++whole;
      if (obliquity(T_scene_camera.translation) > deg_to_rad(config_.max_obliquity_deg)) continue;
      ++steep;
      origins.push_back(T_scene_camera.translation);
    }
    if (whole < needed) return kCutOff;
    if (steep < needed) return kOblique;
    stop->cameras_with_board = 0;
    stop->obliquity_rad = 0.0;
    for (const Eigen::Vector3d& origin : origins) {
      if (!board_in_sight(origin)) continue;
      ++stop->cameras_with_board;
      stop->obliquity_rad = std::max(stop->obliquity_rad, obliquity(origin));
    }
    if (stop->cameras_with_board < needed) return kHidden;
    return std::nullopt;
  }

  std::optional<Rejection> check(int needed, Viewpoint* stop) {
    if (!inside(*stop)) return kOutside;
    if (const std::optional<Rejection> rejection = look(needed, stop)) return rejection;
    if (!world_.obstacle(stop->T_scene_robot()).empty()) return kCollision;
    return std::nullopt;
  }

  // Draws places until as many cameras see the board as are hoped for; after a while is content with those needed.
  std::optional<Viewpoint> draw(RandomStream random, Tally* tally) {
    std::optional<Viewpoint> best;
    const int needed = static_cast<int>(config_.min_cameras), all = static_cast<int>(subject_.cameras.size());
    const int hoped = random.uniform() < config_.all_cameras_share ? all : needed;
    std::int64_t candidates = 0;
    for (int place_index = 0; candidates < config_.max_candidates; ++place_index) {
      if (best && place_index >= kPlacesForAllCameras) break;
      const double distance_m = config_.distance_m.sample(random);
      const double bearing_rad = deg_to_rad(config_.bearing_deg.sample(random));
      for (int k = 0; k < kHeadingsPerPlace && candidates < config_.max_candidates; ++k, ++candidates) {
        Viewpoint stop = place(distance_m, bearing_rad, deg_to_rad(config_.heading_deg.sample(random)));
        ++tally->candidates;
        if (const std::optional<Rejection> rejection = check(needed, &stop)) {
          ++tally->rejected[*rejection];
        } else if (!best || stop.cameras_with_board > best->cameras_with_board) {
          best = stop;
        }
        if (best && best->cameras_with_board >= hoped) return best;
      }
    }
    return best;
  }

 private:
  bool has_whole_board(const Camera& camera, const Rigid3& T_scene_camera) const {
    const Rigid3 T_camera_scene = T_scene_camera.inverse();
    for (const Eigen::Vector3d& corner : outline_) {
      Eigen::Vector2d pixel;
      if (!camera.project(T_camera_scene * corner, &pixel) || !camera.contains(pixel, config_.margin_px)) return false;
    }
    return true;
  }

  // Angle between the board's normal and the line to the camera; beyond 90 degrees it sees the back.
  double obliquity(const Eigen::Vector3d& origin) const {
    return std::acos(std::clamp((origin - centre_).normalized().dot(outward_), -1.0, 1.0));
  }

  bool board_in_sight(const Eigen::Vector3d& origin) {
    return std::all_of(sight_points_.begin(), sight_points_.end(),
                       [&](const Eigen::Vector3d& point) { return world_.in_sight(origin, point); });
  }

  const ViewpointConfig& config_;
  const ViewpointSubject& subject_;
  ViewpointWorld& world_;
  FloorArea area_;
  Eigen::Vector3d outward_, centre_;
  double facing_rad_ = 0.0;
  std::vector<Eigen::Vector3d> outline_, sight_points_;
};

std::vector<Viewpoint> sampled_stops(const ViewpointConfig& config, std::int64_t poses, std::uint64_t seed,
                                     Planner* planner) {
  std::vector<Viewpoint> stops;
  Tally tally;
  for (std::int64_t i = 0; i < poses; ++i) {
    const std::optional<Viewpoint> stop = planner->draw(RandomStream(seed, "viewpoint", i), &tally);
    if (!stop) {
      throw Error("viewpoints: no place found for pose " + std::to_string(i + 1) + " of " + std::to_string(poses) +
                  " in " + std::to_string(config.max_candidates) + " candidates; of all candidates " + tally.text() +
                  "; " + tally.remedy());
    }
    stops.push_back(*stop);
  }
  return stops;
}

std::vector<Viewpoint> grid_stops(const ViewpointConfig& config, Planner* planner, std::size_t* skipped) {
  std::vector<Viewpoint> stops;
  Tally tally;
  for (const double distance_m : config.grid.distances_m) {
    for (const double bearing_deg : config.grid.bearings_deg) {
      for (const double heading_deg : config.grid.headings_deg) {
        Viewpoint stop = planner->place(distance_m, deg_to_rad(bearing_deg), deg_to_rad(heading_deg));
        ++tally.candidates;
        if (const auto rejection = planner->check(static_cast<int>(config.min_cameras), &stop)) {
          ++tally.rejected[*rejection];
        } else {
          stops.push_back(stop);
        }
      }
    }
  }
  *skipped = tally.candidates - stops.size();
  if (stops.empty()) {
    throw Error("viewpoints.grid: none of its " + std::to_string(tally.candidates) +
                " places is possible: " + tally.text() + "; " + tally.remedy());
  }
  return stops;
}

std::vector<Viewpoint> listed_stops(const ViewpointConfig& config, Planner* planner, ViewpointWorld* world) {
  std::vector<Viewpoint> stops;
  Problems problems;
  for (std::size_t i = 0; i < config.list.size(); ++i) {
    const ListedViewpoint& entry = config.list[i];
    const Rigid3 listed = planar_pose(entry.x_m, entry.y_m, deg_to_rad(entry.yaw_deg));
    const Rigid3 T = config.list_frame == "board" ? planner->board_on_floor() * listed : listed;
    Viewpoint stop = planner->at(T.translation.x(), T.translation.y(), yaw_of(T));
    std::string problem;
    if (!planner->inside(stop)) {
      problem = "lies outside of the scene's drivable area";
    } else if (const std::string obstacle = world->obstacle(stop.T_scene_robot()); !obstacle.empty()) {
      problem = "the robot would touch " + obstacle;
    }
    if (!problem.empty()) problems.add({"", 0, "viewpoints.list[" + std::to_string(i) + "]", "", problem});
    planner->look(0, &stop);
    stops.push_back(stop);
  }
  problems.throw_if_any();
  return stops;
}

// Sorts into a drive: from each stop to that one of the next few hundred drawn whose distance is nearest to step_m.
std::vector<Viewpoint> as_drive(std::vector<Viewpoint> drawn, double step_m) {
  for (std::size_t i = 1; i < drawn.size(); ++i) {
    const auto misfit = [&](const Viewpoint& stop) {
      return std::abs(std::hypot(stop.x_m - drawn[i - 1].x_m, stop.y_m - drawn[i - 1].y_m) - step_m);
    };
    const auto first = drawn.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last = first + static_cast<std::ptrdiff_t>(std::min(kDriveWindow, drawn.size() - i));
    const auto best =
        std::min_element(first, last, [&](const Viewpoint& a, const Viewpoint& b) { return misfit(a) < misfit(b); });
    std::rotate(first, best, best + 1);  // keeps the others in the order in which they were drawn
  }
  return drawn;
}

template <typename Value>
std::string range(const std::vector<Viewpoint>& stops, int digits, const Value& value) {
  double low = value(stops.front()), high = low;
  for (const Viewpoint& stop : stops) {
    low = std::min(low, value(stop));
    high = std::max(high, value(stop));
  }
  return fixed_text(low, digits) + " to " + fixed_text(high, digits);
}

std::string board_counts(const std::vector<Viewpoint>& stops, std::size_t cameras) {
  std::vector<std::size_t> counts(cameras + 1);
  for (const Viewpoint& stop : stops) ++counts[static_cast<std::size_t>(stop.cameras_with_board)];
  std::string text = "board whole in ";
  bool first = true;
  for (std::size_t seen = cameras + 1; seen-- > 0;) {
    if (counts[seen] == 0) continue;
    text += (first ? "" : ", ") + (seen == cameras && cameras > 1 ? "all " : std::string()) + std::to_string(seen) +
            (seen == 1 ? " camera" : " cameras") + " at " + std::to_string(counts[seen]) + " stops";
    first = false;
  }
  return text;
}

std::string steps_text(const std::vector<Viewpoint>& stops) {
  if (stops.size() < 2) return "no motion";
  double length = 0.0, turn = 0.0;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    length += std::hypot(stops[i].x_m - stops[i - 1].x_m, stops[i].y_m - stops[i - 1].y_m);
    turn += std::abs(wrap_angle(stops[i].yaw_rad - stops[i - 1].yaw_rad));
  }
  const double steps = static_cast<double>(stops.size() - 1);
  return "steps of " + fixed_text(length / steps, 2) + " m and " + fixed_text(rad_to_deg(turn / steps), 0) +
         " deg on average";
}

}  // namespace

std::string ComposedViewpointWorld::obstacle(const Rigid3& T_scene_robot) {
  world_.place_robot(T_scene_robot);
  const std::vector<std::string> names = world_.collisions();
  return names.empty() ? std::string() : names.front();
}

bool ComposedViewpointWorld::in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target) {
  ObjectKind hit = ObjectKind::kNothing;
  world_.cast_ray(origin, (target - origin).normalized(), &hit);
  return hit == ObjectKind::kBoard;
}

std::string describe_coverage(const std::vector<Viewpoint>& stops, std::size_t cameras) {
  if (stops.empty()) return "no stop";
  return std::to_string(stops.size()) + (stops.size() == 1 ? " stop " : " stops ") +
         range(stops, 1, [](const Viewpoint& s) { return s.distance_m; }) + " m from the board, bearing " +
         range(stops, 0, [](const Viewpoint& s) { return rad_to_deg(s.bearing_rad); }) + " deg, seen at " +
         range(stops, 0, [](const Viewpoint& s) { return rad_to_deg(s.obliquity_rad); }) + " deg obliquity; " +
         board_counts(stops, cameras) + "; " + steps_text(stops);
}

std::optional<Viewpoint> draw_viewpoint(const ViewpointConfig& config, std::int64_t number,
                                        const ViewpointSubject& subject, ViewpointWorld& world, std::uint64_t seed) {
  Tally tally;
  return Planner(config, subject, world).draw(RandomStream(seed, "viewpoint", number), &tally);
}

ViewpointPlan plan_viewpoints(const ViewpointConfig& config, std::int64_t poses, const ViewpointSubject& subject,
                              ViewpointWorld& world, std::uint64_t seed) {
  if (config.min_cameras > static_cast<std::int64_t>(subject.cameras.size())) {
    throw Error("viewpoints.min_cameras: " + std::to_string(config.min_cameras) + ": the rig has only " +
                std::to_string(subject.cameras.size()) + " cameras");
  }
  Planner planner(config, subject, world);
  ViewpointPlan plan;
  if (config.planner == "list") {
    plan.stops = listed_stops(config, &planner, &world);
  } else {
    plan.stops = config.planner == "grid" ? grid_stops(config, &planner, &plan.skipped)
                                          : sampled_stops(config, poses, seed, &planner);
    if (config.order == "drive") plan.stops = as_drive(std::move(plan.stops), config.step_m);
  }
  plan.coverage = describe_coverage(plan.stops, subject.cameras.size());
  if (plan.skipped > 0) {
    plan.coverage += "; " + std::to_string(plan.skipped) + " places of the grid left out, where a constraint is broken";
  }
  return plan;
}

}  // namespace rigproof
