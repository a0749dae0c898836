#include "rigproof/generator/straight_drive.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

Viewpoint place_on(const StraightPath& path, double share) {
  const double heading = deg_to_rad(path.heading_deg), along = share * path.length_m;
  Viewpoint stop;
  stop.x_m = path.x_m + along * std::cos(heading);
  stop.y_m = path.y_m + along * std::sin(heading);
  stop.yaw_rad = wrap_angle(heading);
  return stop;
}

}  // namespace

void StraightDriveConfig::visit(FieldVisitor& visitor) {
  visitor.field("frames", frames, {0.0, 10000.0},
                "of each camera along the scene's straight path, after the last viewpoint and without the board; 0 = "
                "none. `segments.csv` tells when; board calibration leaves them alone");
  visitor.check(frames == 0 || frames >= 3, "frames", "must be 0, or at least 3 for a straight line");
}

void append_straight_stops(const StraightDriveConfig& config, const StraightPath& path, ViewpointWorld& world,
                           ViewpointPlan* plan) {
  if (config.frames == 0) return;
  if (!(path.length_m > 0.0))
    throw Error("straight_drive.frames: the scene has no straight_path; give it one, or set frames to 0");
  for (std::int64_t i = 0; i < config.frames; ++i) {
    const Viewpoint stop = place_on(path, static_cast<double>(i) / static_cast<double>(config.frames - 1));
    const std::string obstacle = world.obstacle(stop.T_scene_robot());
    if (!obstacle.empty()) throw Error("the scene's straight_path: the robot would touch " + obstacle);
    plan->stops.push_back(stop);
    ++plan->straight;
  }
}

std::size_t trailing_straight_stops(const std::vector<Viewpoint>& stops) {
  // A viewpoint stands away from the board; a place on the path was never related to it.
  const auto is_viewpoint = [](const Viewpoint& stop) { return stop.distance_m > 0.0; };
  return static_cast<std::size_t>(std::find_if(stops.rbegin(), stops.rend(), is_viewpoint) - stops.rbegin());
}

RecordingSegment straight_segment(const std::vector<TrueStop>& stops, std::size_t count) {
  const std::size_t first = stops.size() - count;
  double step_s = stops.back().stamp_s - stops.front().stamp_s;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < stops.size(); ++i)
    step_s = std::min(step_s, stops[i].stamp_s - stops[i - 1].stamp_s);
  return {kStraightSegment, stops[first].stamp_s - 0.5 * step_s, stops.back().stamp_s + 0.5 * step_s};
}

}  // namespace rigproof
