#include "driven.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/generator/straight_drive.h"

namespace rigproof {
namespace {

// A viewpoint keeps this much more distance than the way there, since the robot stops beside it by its tolerance.
constexpr double kExtraClearance_m = 0.02;
constexpr double kDefaultRate_hz = 50.0;

class DrivableWorld : public ViewpointWorld {
 public:
  DrivableWorld(World& world, const DrivePhysics& physics, double clearance_m)
      : composed_(world), physics_(physics), clearance_m_(clearance_m) {}
  FloorArea drivable_area() override { return composed_.drivable_area(); }
  std::string obstacle(const Rigid3& T_scene_robot) override { return physics_.obstacle(T_scene_robot, clearance_m_); }
  bool in_sight(const Eigen::Vector3d& origin, const Eigen::Vector3d& target, std::size_t board) override {
    return composed_.in_sight(origin, target, board);
  }

 private:
  ComposedViewpointWorld composed_;
  const DrivePhysics& physics_;
  double clearance_m_;
};

FloorPose floor_pose(const Viewpoint& stop) { return {Eigen::Vector2d(stop.x_m, stop.y_m), stop.yaw_rad}; }

// The board stays in the image, although the robot stops a little beside its viewpoint.
ViewpointConfig with_tolerance(const GenerateConfig& config, const ViewpointSubject& subject) {
  ViewpointConfig viewpoints = config.viewpoints;
  const double nearest_m = std::max(0.5, viewpoints.distance_m.lowest());
  const double angle = deg_to_rad(config.drive.tolerance_deg) + 0.01 * config.drive.tolerance_cm / nearest_m;
  double focal_px = 0.0;
  for (const WorldCamera& camera : subject.cameras) focal_px = std::max(focal_px, camera.camera.fx_px);
  viewpoints.margin_px += focal_px * angle;
  return viewpoints;
}

WheelGeometry wheels_of(const RobotModel& robot) {
  return {robot.wheel_radius_m, robot.track_m * robot.slip_factor, robot.encoder_ticks_per_turn};
}

std::string describe_drive(const Drive& drive) {
  return fmt::format(
      "; driven {:.0f} m in {:.0f} s, at rest within {:.1f} cm and {:.1f} deg of the plan; {} ways tried again, {} "
      "viewpoints replaced",
      drive.trajectory.length_m(), drive.duration_s, 100.0 * drive.worst_position_m,
      rad_to_deg(drive.worst_heading_rad), drive.ways_tried_again, drive.given_up);
}

const Viewpoint& planned_at(const std::vector<Viewpoint>& stops, const FloorPose& pose) {
  const auto same = [&](const Viewpoint& stop) {
    return stop.x_m == pose.position.x() && stop.y_m == pose.position.y() && stop.yaw_rad == pose.yaw_rad;
  };
  return *std::find_if(stops.begin(), stops.end(), same);
}

}  // namespace

GroundRelief ground_of(const DriveConfig& config, const FloorArea& area, std::uint64_t seed) {
  // Beyond the reach of wheels the ground turns level, where walls, trees and houses stand.
  constexpr double kFall_m = 1.0;
  GroundRelief ground;
  ground.waves = uneven_floor(0.001 * config.unevenness_mm, config.unevenness_length_m, seed);
  for (const RampConfig& ramp : config.ramps)
    ground.ramps.push_back({ramp.x_m, ramp.y_m, deg_to_rad(ramp.heading_deg), 0.01 * ramp.height_cm, ramp.level_m,
                            ramp.rise_m, ramp.width_m});
  ground.extent = GroundRelief::Extent{0.5 * (area.x_min + area.x_max), 0.5 * (area.y_min + area.y_max),
                                       0.5 * (area.x_max - area.x_min) + kWheelReach_m,
                                       0.5 * (area.y_max - area.y_min) + kWheelReach_m, kFall_m};
  return ground;
}

DrivePhysicsDraw draw_physics(const DriveConfig& config, std::uint64_t seed) {
  DrivePhysicsDraw result;
  RandomStream random(seed, "drive");
  const auto draw = [&](const char* name, const Distribution& distribution) {
    return result.drawn[std::string("drive.") + name] = distribution.sample(random);
  };
  result.physics.wheel_diameter_ratio = draw("wheel_diameter_ratio", config.wheel_diameter_ratio);
  result.physics.friction = draw("friction", config.friction);
  result.physics.payload_kg = draw("payload_kg", config.payload_kg);
  const double x = draw("payload_x_m", config.payload_x_m), y = draw("payload_y_m", config.payload_y_m);
  result.physics.payload_at_m = Eigen::Vector3d(x, y, draw("payload_z_m", config.payload_z_m));
  return result;
}

DrivenViewpoints drive_viewpoints(const GenerateConfig& config, const WorldDescription& description,
                                  const RobotModel& robot, const ViewpointSubject& subject, World& world,
                                  const PhysicsOptions& options,
                                  const std::function<bool(std::size_t, std::size_t)>& progress) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  DrivePhysics physics(description, options);
  DrivableWorld drivable(world, physics, 0.01 * config.drive.clearance_cm + kExtraClearance_m);
  const ViewpointConfig viewpoints = with_tolerance(config, subject);
  DrivenViewpoints result;
  result.plan = plan_viewpoints(viewpoints, config.poses, subject, drivable, seed);
  append_straight_stops(config.straight_drive, description.scene.straight_path, drivable, &result.plan);
  if (result.plan.straight > 0 && config.drive.capture == "moving")
    throw Error("straight_drive.frames: needs drive.capture: standing");
  std::vector<Viewpoint> known = result.plan.stops;
  DriveRequest request;
  request.config = config.drive;
  request.wheels = wheels_of(robot);
  request.odometry_rate_hz = config.odometry.rate_hz > 0.0 ? config.odometry.rate_hz : kDefaultRate_hz;
  request.area = drivable.drivable_area();
  request.straight_goals = result.plan.straight;
  for (const Viewpoint& stop : known) request.goals.push_back(floor_pose(stop));
  if (progress)
    request.progress = [&progress, count = request.goals.size()](std::size_t reached) {
      return progress(reached, count);
    };
  std::int64_t next = config.poses;
  if (viewpoints.draws())
    request.replacement = [&]() -> std::optional<FloorPose> {
      const std::optional<Viewpoint> stop = draw_viewpoint(viewpoints, next++, subject, drivable, known, seed);
      if (!stop) return std::nullopt;
      known.push_back(*stop);
      return floor_pose(*stop);
    };
  result.drive = simulate_drive(physics, request);
  result.plan.stops.clear();
  for (const FloorPose& pose : result.drive.reached) result.plan.stops.push_back(planned_at(known, pose));
  result.plan.straight = trailing_straight_stops(result.plan.stops);
  const std::vector<Viewpoint> viewpoints_reached(
      result.plan.stops.begin(), result.plan.stops.end() - static_cast<std::ptrdiff_t>(result.plan.straight));
  result.plan.coverage = describe_coverage(viewpoints_reached, subject.cameras.size()) + describe_drive(result.drive);
  return result;
}

OdometrySample odometry_at(const std::vector<OdometrySample>& odometry, double stamp_s) {
  const auto after =
      std::lower_bound(odometry.begin(), odometry.end(), stamp_s,
                       [](const OdometrySample& sample, double stamp) { return sample.stamp_s < stamp; });
  if (after == odometry.begin()) return odometry.front();
  if (after == odometry.end()) return odometry.back();
  const OdometrySample &b = *after, &a = *std::prev(after);
  const double share = (stamp_s - a.stamp_s) / (b.stamp_s - a.stamp_s);
  return {stamp_s, a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
          wrap_angle(a.yaw_rad + share * wrap_angle(b.yaw_rad - a.yaw_rad))};
}

OdometryFit fit_odometry(const std::vector<TrueStop>& stops, const std::vector<OdometrySample>& measured) {
  struct Increment {
    Eigen::Vector2d measured, truth;
    double measured_turn, true_turn;
  };
  const auto planar = [](const Rigid3& T) { return planar_pose(T.translation.x(), T.translation.y(), yaw_of(T)); };
  const auto pose = [](const OdometrySample& s) { return planar_pose(s.x_m, s.y_m, s.yaw_rad); };
  std::vector<Increment> increments;
  double mt = 0.0, tt = 0.0, ab = 0.0, bb = 0.0;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const Rigid3 T = planar(stops[i - 1].T_world_robot).inverse() * planar(stops[i].T_world_robot);
    const Rigid3 M = pose(measured[i - 1]).inverse() * pose(measured[i]);
    Increment step{M.translation.head<2>(), T.translation.head<2>(), 0.0, yaw_of(T)};
    step.measured_turn = step.true_turn + wrap_angle(yaw_of(M) - step.true_turn);
    mt += step.measured.dot(step.truth);
    tt += step.truth.squaredNorm();
    ab += step.measured_turn * step.true_turn;
    bb += step.true_turn * step.true_turn;
    increments.push_back(step);
  }
  OdometryFit fit;
  if (tt > 0.0) fit.scale = mt / tt;
  if (bb > 0.0) fit.yaw_factor = ab / bb;
  double xy = 0.0, yaw = 0.0;
  for (const Increment& step : increments) {
    xy += 0.5 * (step.measured - fit.scale * step.truth).squaredNorm();
    yaw += std::pow(step.measured_turn - fit.yaw_factor * step.true_turn, 2);
  }
  const double count = std::max<double>(1.0, static_cast<double>(increments.size()));
  fit.rms_xy_m = std::sqrt(xy / count);
  fit.rms_yaw_rad = std::sqrt(yaw / count);
  return fit;
}

}  // namespace rigproof
