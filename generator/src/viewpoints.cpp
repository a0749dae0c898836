#include "rigproof/generator/viewpoints.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "covering.h"
#include "places.h"
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

// Draws places until as many cameras see the board as are hoped for; after a while is content with those needed.
std::optional<Viewpoint> drawn_stop(const ViewpointConfig& config, std::size_t cameras, const Places& places,
                                    RandomStream random, Tally* tally) {
  std::optional<Viewpoint> best;
  const int needed = static_cast<int>(config.min_cameras), all = static_cast<int>(cameras);
  const int hoped = random.uniform() < config.all_cameras_share ? all : needed;
  std::int64_t candidates = 0;
  for (int place_index = 0; candidates < config.max_candidates; ++place_index) {
    if (best && place_index >= kPlacesForAllCameras) break;
    const double distance_m = config.distance_m.sample(random);
    const double bearing_rad = deg_to_rad(config.bearing_deg.sample(random));
    for (int k = 0; k < kHeadingsPerPlace && candidates < config.max_candidates; ++k, ++candidates) {
      Viewpoint stop = places.place(distance_m, bearing_rad, deg_to_rad(config.heading_deg.sample(random)));
      ++tally->candidates;
      if (const std::optional<Rejection> rejection = places.check(needed, &stop)) {
        ++tally->rejected[*rejection];
      } else if (!best || stop.cameras_with_board > best->cameras_with_board) {
        best = stop;
      }
      if (best && best->cameras_with_board >= hoped) return best;
    }
  }
  return best;
}

// Draws stop after stop as the planners `covering` and `sampled` do.
class StopDrawer {
 public:
  StopDrawer(const ViewpointConfig& config, const ViewpointSubject& subject, const Places& places, std::uint64_t seed)
      : config_(config), cameras_(subject.cameras.size()), places_(places), seed_(seed) {
    if (config.planner == "covering") covering_.emplace(config, subject, places);
  }

  void add(const Viewpoint& stop) {
    if (covering_) covering_->add(stop);
  }

  std::optional<Viewpoint> draw(std::int64_t number, Tally* tally) const {
    const RandomStream random(seed_, "viewpoint", number);
    return covering_ ? covering_->next(random, tally) : drawn_stop(config_, cameras_, places_, random, tally);
  }

 private:
  const ViewpointConfig& config_;
  std::size_t cameras_;
  const Places& places_;
  std::uint64_t seed_;
  std::optional<CoveringPlanner> covering_;
};

std::vector<Viewpoint> drawn_stops(const ViewpointConfig& config, std::int64_t poses, StopDrawer drawer) {
  std::vector<Viewpoint> stops;
  Tally tally;
  for (std::int64_t i = 0; i < poses; ++i) {
    const std::optional<Viewpoint> stop = drawer.draw(i, &tally);
    if (!stop) {
      throw Error("viewpoints: no place found for pose " + std::to_string(i + 1) + " of " + std::to_string(poses) +
                  " in " + std::to_string(config.max_candidates) + " candidates; of all candidates " + tally.text() +
                  "; " + tally.remedy());
    }
    stops.push_back(*stop);
    drawer.add(*stop);
  }
  return stops;
}

std::vector<Viewpoint> grid_stops(const ViewpointConfig& config, const Places& places, std::size_t* skipped) {
  std::vector<Viewpoint> stops;
  Tally tally;
  for (const double distance_m : config.grid.distances_m) {
    for (const double bearing_deg : config.grid.bearings_deg) {
      for (const double heading_deg : config.grid.headings_deg) {
        Viewpoint stop = places.place(distance_m, deg_to_rad(bearing_deg), deg_to_rad(heading_deg));
        ++tally.candidates;
        if (const auto rejection = places.check(static_cast<int>(config.min_cameras), &stop)) {
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

std::vector<Viewpoint> listed_stops(const ViewpointConfig& config, const Places& places, ViewpointWorld* world) {
  std::vector<Viewpoint> stops;
  Problems problems;
  for (std::size_t i = 0; i < config.list.size(); ++i) {
    const ListedViewpoint& entry = config.list[i];
    const Rigid3 listed = planar_pose(entry.x_m, entry.y_m, deg_to_rad(entry.yaw_deg));
    const Rigid3 T = config.list_frame == "board" ? places.board_on_floor() * listed : listed;
    Viewpoint stop = places.at(T.translation.x(), T.translation.y(), yaw_of(T));
    std::string problem;
    if (!places.inside(stop)) {
      problem = "lies outside of the scene's drivable area";
    } else if (const std::string obstacle = world->obstacle(stop.T_scene_robot()); !obstacle.empty()) {
      problem = "the robot would touch " + obstacle;
    }
    if (!problem.empty()) problems.add({"", 0, "viewpoints.list[" + std::to_string(i) + "]", "", problem});
    places.look(0, &stop);
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

bool ComposedViewpointWorld::in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, std::size_t board) {
  return world_.cast_ray_to_board(origin, (target - origin).normalized()) == board;
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
                                        const ViewpointSubject& subject, ViewpointWorld& world,
                                        const std::vector<Viewpoint>& before, std::uint64_t seed) {
  const Places places(config, subject, world);
  StopDrawer drawer(config, subject, places, seed);
  for (const Viewpoint& stop : before) drawer.add(stop);
  Tally tally;
  return drawer.draw(number, &tally);
}

ViewpointPlan plan_viewpoints(const ViewpointConfig& config, std::int64_t poses, const ViewpointSubject& subject,
                              ViewpointWorld& world, std::uint64_t seed) {
  if (config.min_cameras > static_cast<std::int64_t>(subject.cameras.size())) {
    throw Error("viewpoints.min_cameras: " + std::to_string(config.min_cameras) + ": the rig has only " +
                std::to_string(subject.cameras.size()) + " cameras");
  }
  const Places places(config, subject, world);
  ViewpointPlan plan;
  if (config.planner == "list") {
    plan.stops = listed_stops(config, places, &world);
  } else {
    plan.stops = config.planner == "grid" ? grid_stops(config, places, &plan.skipped)
                                          : drawn_stops(config, poses, StopDrawer(config, subject, places, seed));
    if (config.order == "drive") plan.stops = as_drive(std::move(plan.stops), config.step_m);
  }
  plan.coverage = describe_coverage(plan.stops, subject.cameras.size());
  if (plan.skipped > 0) {
    plan.coverage += "; " + std::to_string(plan.skipped) + " places of the grid left out, where a constraint is broken";
  }
  return plan;
}

}  // namespace rigproof
