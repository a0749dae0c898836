#include "rigproof/generator/drive.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr double kControlPeriod_s = 0.01;
constexpr double kTrajectoryPeriod_s = 0.01;
// Braking is planned with this share of what the wheels can do, so that the robot ends where it is to.
constexpr double kBrakeShare = 0.6;
// A turn accelerates within this time to its full rate.
constexpr double kTurnRise_s = 0.35;
constexpr double kTurnDone_rad = 0.002, kTurnDone_rad_s = 0.02;
constexpr double kWayDone_m = 0.002;
// Slower than this the wheels' stiction decides.
constexpr double kCreep_m_s = 0.02, kCreep_rad_s = 0.05;
// Line following: curvature from the heading error [rad/s per rad] and from the offset [1/m^2 times speed].
constexpr double kHeadingGain = 3.0, kOffsetGain = 4.0;
// Wheels at rest are held in their place by this [1/s]: the motors brake.
constexpr double kHoldGain = 10.0;
constexpr double kLookPeriod_s = 0.05;
constexpr double kTipped_rad = 0.6;
// Beyond the time that a piece of way takes with constant speed the robot is stuck.
constexpr double kPatience = 3.0, kPatience_s = 5.0;
constexpr int kMaxCorrections = 6;
// Another plan keeps away from a place of trouble by this.
constexpr double kAvoid_m = 0.7;
// Still enough to take images.
constexpr double kStill_m_s = 2e-4, kStill_rad_s = 5e-4;
constexpr double kMaxSettle_s = 10.0;
// The robot stands on after an image for this long.
constexpr double kAfterImage_s = 0.2;
// Share of the viewpoints that may be replaced, and how many at least.
constexpr double kReplaceable = 0.5;
constexpr std::size_t kReplaceableAtLeast = 10;

std::string place_text(const FloorPose& pose) {
  return fmt::format("({:.2f} m, {:.2f} m, {:.0f} deg)", pose.position.x(), pose.position.y(),
                     rad_to_deg(pose.yaw_rad));
}

// Stops at 0 from `rest` away with the given deceleration.
double braking_speed(double rest, double deceleration, double limit) {
  return std::copysign(std::min(limit, std::sqrt(2.0 * deceleration * std::abs(rest))), rest);
}

double at_least(double value, double least) { return std::copysign(std::max(std::abs(value), least), value); }

using Kind = DriveTrouble::Kind;

/// Why a way came to nothing; absent: it did not.
struct Failure {
  Kind kind;
  std::string what;
};
using MaybeFailure = std::optional<Failure>;

/// The robot on its way, with what is recorded of it.
class DrivenRobot {
 public:
  struct WheelAngles {
    double left_rad, right_rad;
  };
  /// What a failed way is taken back to.
  struct Checkpoint {
    std::shared_ptr<const DrivePhysics::Snapshot> physics;
    std::int64_t steps;
    WheelOdometer odometer;
    std::size_t odometry_rows;
  };

  /// Puts it on its place.
  DrivenRobot(DrivePhysics& physics, const DriveRequest& request, const FloorPose& first)
      : physics_(physics), request_(request), odometer_(placed(physics, request, first)) {
    record_step();
  }

  double time_s() const { return static_cast<double>(steps_) * physics_.step_s(); }
  Rigid3 T_scene_robot() const { return physics_.T_world_robot(); }
  WheelAngles wheels() const { return {physics_.left_wheels_rad(), physics_.right_wheels_rad()}; }
  double turn_rate_rad_s() const { return physics_.turn_rate_rad_s(); }
  bool moves_faster_than(double times_still) const {
    return physics_.speed_m_s() > times_still * kStill_m_s || physics_.turn_rate_rad_s() > times_still * kStill_rad_s;
  }

  FloorPose pose() const {
    const Rigid3 T = physics_.T_world_robot();
    return {T.translation.head<2>(), yaw_of(T)};
  }

  Checkpoint checkpoint() const { return {physics_.save(), steps_, odometer_, odometry_.size()}; }

  void restore(const Checkpoint& checkpoint) {
    physics_.restore(*checkpoint.physics);
    steps_ = looked_at_ = checkpoint.steps;
    odometer_ = checkpoint.odometer;
    odometry_.resize(checkpoint.odometry_rows);
    trajectory_.cut_after(time_s() + 0.5 * physics_.step_s());
    speed_ = turn_rate_ = 0.0;
  }

  /// One period of control with accelerations limited.
  MaybeFailure advance(double speed, double turn_rate) {
    const DriveConfig& config = request_.config;
    const double dv = config.acceleration_m_s2 * kControlPeriod_s;
    const double dw = deg_to_rad(config.max_turn_deg_s) / kTurnRise_s * kControlPeriod_s;
    speed_ += std::clamp(speed - speed_, -dv, dv);
    turn_rate_ += std::clamp(turn_rate - turn_rate_, -dw, dw);
    const double difference = 0.5 * turn_rate_ * request_.wheels.effective_track_m;
    const double left = (speed_ - difference) / request_.wheels.wheel_radius_m;
    const double right = (speed_ + difference) / request_.wheels.wheel_radius_m;
    run(kControlPeriod_s, [&] { physics_.step(left, right); });
    return look(kLookPeriod_s);
  }

  /// Brakes, holds the wheels where they are, and waits until it nearly stands.
  void brake(double most_s) {
    speed_ = turn_rate_ = 0.0;
    const WheelAngles hold = wheels();
    const double deadline = time_s() + most_s;
    while (time_s() < deadline && !look(kLookPeriod_s) && moves_faster_than(50.0)) stand(kControlPeriod_s, hold);
  }

  void stand(double duration_s, const WheelAngles& hold) {
    run(duration_s, [&] {
      physics_.step(kHoldGain * (hold.left_rad - physics_.left_wheels_rad()),
                    kHoldGain * (hold.right_rad - physics_.right_wheels_rad()));
    });
  }

  /// Looks for a touch once a period: in between the robot goes on by less than ways keep clear.
  MaybeFailure look(double period_s) {
    if (steps_ - looked_at_ < std::lround(period_s / physics_.step_s())) return std::nullopt;
    looked_at_ = steps_;
    const std::string touched = physics_.touched();
    if (physics_.tilt_rad() > kTipped_rad) return Failure{Kind::kTippedOver, ""};
    if (!touched.empty()) return Failure{Kind::kTouches, touched};
    return std::nullopt;
  }

  void hand_over(Drive* drive) {
    drive->odometry = std::move(odometry_);
    drive->trajectory = std::move(trajectory_);
  }

 private:
  static WheelOdometer placed(DrivePhysics& physics, const DriveRequest& request, const FloorPose& first) {
    physics.place(first.position.x(), first.position.y(), first.yaw_rad);
    return {request.wheels, physics.left_wheels_rad(), physics.right_wheels_rad()};
  }

  template <typename Step>
  void run(double duration_s, const Step& step) {
    const auto count = static_cast<std::int64_t>(std::lround(duration_s / physics_.step_s()));
    for (std::int64_t i = 0; i < std::max<std::int64_t>(count, 1); ++i) {
      step();
      ++steps_;
      record_step();
    }
  }

  // True once a period, at the first step at or after its multiple.
  bool is_due(double period_s) const {
    const double step = physics_.step_s(), tolerance = 1e-6 * step;
    return steps_ == 0 ||
           std::floor((time_s() + tolerance) / period_s) > std::floor((time_s() - step + tolerance) / period_s);
  }

  void record_step() {
    if (is_due(1.0 / request_.odometry_rate_hz))
      odometry_.push_back(odometer_.update(time_s(), physics_.left_wheels_rad(), physics_.right_wheels_rad()));
    if (is_due(kTrajectoryPeriod_s)) trajectory_.add(time_s(), physics_.T_world_robot());
  }

  DrivePhysics& physics_;
  const DriveRequest& request_;
  WheelOdometer odometer_;
  std::vector<OdometrySample> odometry_;
  RobotTrajectory trajectory_;
  std::int64_t steps_ = 0;
  std::int64_t looked_at_ = -1000000;     ///< step
  double speed_ = 0.0, turn_rate_ = 0.0;  ///< commanded
};

// A turn on the spot by this angle.
MaybeFailure turn_by(double turn_rad, const DriveConfig& config, DrivenRobot* robot) {
  const double limit = deg_to_rad(config.max_turn_deg_s), rise = limit / kTurnRise_s;
  const double deadline = robot->time_s() + kPatience_s + kPatience * std::abs(turn_rad) / limit;
  double yaw = robot->pose().yaw_rad, rest = turn_rad;
  while (std::abs(rest) > kTurnDone_rad || robot->turn_rate_rad_s() > kTurnDone_rad_s) {
    if (robot->time_s() > deadline) return Failure{Kind::kDoesNotTurn, ""};
    const bool there = std::abs(rest) <= kTurnDone_rad;
    const double rate = there ? 0.0 : at_least(braking_speed(rest, kBrakeShare * rise, limit), kCreep_rad_s);
    if (const MaybeFailure failure = robot->advance(0.0, rate)) return failure;
    const double now = robot->pose().yaw_rad;
    rest -= wrap_angle(now - yaw);
    yaw = now;
  }
  return std::nullopt;
}

// The planned turn may go the long way round; what slip has left over is added.
MaybeFailure turn_to(const RouteLeg& leg, const DriveConfig& config, DrivenRobot* robot) {
  const double rest = wrap_angle(leg.end.yaw_rad - robot->pose().yaw_rad);
  double turn = rest;
  if (std::abs(leg.turn_rad) > kPi && leg.turn_rad * rest < 0.0) turn += std::copysign(2.0 * kPi, leg.turn_rad);
  return turn_by(turn, config, robot);
}

MaybeFailure drive_to(const RouteLeg& leg, const DriveConfig& config, DrivenRobot* robot) {
  const Eigen::Vector2d from = robot->pose().position, way = leg.end.position - from;
  const double length = way.norm();
  if (length < kWayDone_m) return std::nullopt;
  const Eigen::Vector2d along = way / length, left(-along.y(), along.x());
  const double heading = std::atan2(along.y(), along.x()) + (leg.backwards ? kPi : 0.0);
  const double direction = leg.backwards ? -1.0 : 1.0;
  const double deadline = robot->time_s() + kPatience_s + kPatience * length / config.max_speed_m_s;
  while (true) {
    const FloorPose here = robot->pose();
    const double rest = length - (here.position - from).dot(along);
    if (rest < kWayDone_m) return std::nullopt;
    if (robot->time_s() > deadline) return Failure{Kind::kDoesNotGetOn, ""};
    const double speed =
        at_least(braking_speed(rest, kBrakeShare * config.acceleration_m_s2, config.max_speed_m_s), kCreep_m_s);
    const double offset = (here.position - from).dot(left);
    const double turn = -kHeadingGain * wrap_angle(here.yaw_rad - heading) - kOffsetGain * speed * offset;
    if (const MaybeFailure failure = robot->advance(direction * speed, turn)) return failure;
  }
}

MaybeFailure follow(const Route& route, const DriveConfig& config, DrivenRobot* robot) {
  for (const RouteLeg& leg : route) {
    const bool turns = leg.kind == RouteLeg::Kind::kTurn;
    if (const MaybeFailure failure = turns ? turn_to(leg, config, robot) : drive_to(leg, config, robot)) return failure;
    robot->brake(kMaxSettle_s);
  }
  return std::nullopt;
}

std::vector<Capture> captures_along(const RobotTrajectory& trajectory, double duration_s, double rate_hz) {
  std::vector<Capture> captures;
  const double period = 1.0 / rate_hz;
  for (std::int64_t i = 1; static_cast<double>(i) * period < duration_s; ++i) {
    const double stamp = static_cast<double>(i) * period;
    captures.push_back({stamp, trajectory.at(stamp)});
  }
  return captures;
}

// Every plan's end, and what to change.
std::string what_failed(const Drive& drive, std::size_t goal, bool is_straight) {
  std::string text;
  bool lacks_way = false, fails_on_way = false;
  for (const DriveTrouble& trouble : drive.troubles) {
    if (trouble.goal != goal) continue;
    text += " " + trouble.text() + " at " + place_text(trouble.at) + ";";
    (trouble.lacks_way() ? lacks_way : fails_on_way) = true;
  }
  const std::string change =
      is_straight ? " change straight_drive.frames, the scene's straight_path," : " change viewpoints,";
  if (lacks_way || !fails_on_way) text += change + " drive.clearance_cm, or the place of the board";
  if (fails_on_way)
    text += std::string(lacks_way ? "," : change) +
            " or what it drives on and carries: drive.friction, unevenness_mm, ramps, payload_kg";
  if (drive.given_up > 1) text += " (" + std::to_string(drive.given_up) + " viewpoints were given up)";
  return text;
}

/// Finds ways to the goals, and others where one fails.
class Driver {
 public:
  Driver(DrivePhysics& physics, const DriveRequest& request)
      : physics_(physics),
        request_(request),
        config_(request.config),
        goals_(request.goals),
        robot_(physics, request, checked(goals_.front())) {}

  Drive drive() {
    if (const MaybeFailure failure = stand_and_capture(0)) {
      drive_.troubles.push_back({0, robot_.pose(), failure->kind, failure->what});
      refuse(0);
    }
    for (std::size_t i = 1; i < goals_.size(); ++i) {
      if (request_.progress && !request_.progress(drive_.reached.size()))
        throw Error("interrupted while driving; the same command starts the drive again", ExitCode::kTryAgain);
      visit(i);
    }
    drive_.duration_s = robot_.time_s();
    drive_.ways_tried_again = drive_.troubles.size();
    robot_.hand_over(&drive_);
    if (config_.capture == "moving")
      drive_.captures = captures_along(drive_.trajectory, drive_.duration_s, config_.frame_rate_hz);
    return std::move(drive_);
  }

 private:
  using Avoided = std::vector<DriveTrouble>;

  RoutePlanner planner_for(double clearance_m, const Avoided& avoided) const {
    return RoutePlanner(request_.area, [this, clearance_m, avoided](const FloorPose& pose) {
      for (const DriveTrouble& trouble : avoided)
        if ((trouble.at.position - pose.position).norm() < kAvoid_m)
          return "the place where the robot " + trouble.text();
      return physics_.obstacle(planar_pose(pose.position.x(), pose.position.y(), pose.yaw_rad), clearance_m);
    });
  }

  const FloorPose& checked(const FloorPose& first) const {
    const std::string obstacle =
        physics_.obstacle(planar_pose(first.position.x(), first.position.y(), first.yaw_rad), 0.0);
    if (!obstacle.empty()) throw Error(name_of(0) + " at " + place_text(first) + ": the robot would touch " + obstacle);
    return first;
  }

  bool is_straight(std::size_t goal) const { return goal + request_.straight_goals >= goals_.size(); }

  std::string name_of(std::size_t goal) const {
    if (!is_straight(goal)) return "viewpoint " + std::to_string(goal + 1);
    return "frame " + std::to_string(goal + 1 + request_.straight_goals - goals_.size()) + " of the straight drive";
  }

  void visit(std::size_t goal) {
    if (try_plans(goal)) return;
    ++drive_.given_up;
    const std::size_t most = std::max(
        kReplaceableAtLeast, static_cast<std::size_t>(kReplaceable * static_cast<double>(request_.goals.size())));
    std::optional<FloorPose> other;
    if (request_.replacement && !is_straight(goal) && drive_.given_up <= most) other = request_.replacement();
    if (!other) refuse(goal);
    goals_.insert(goals_.end() - static_cast<std::ptrdiff_t>(request_.straight_goals), *other);
  }

  // Another plan avoids the place where the one before failed; where start or goal are too near to it, it takes the
  // next best way.
  bool try_plans(std::size_t goal) {
    const DrivenRobot::Checkpoint before = robot_.checkpoint();
    Avoided avoided;
    int number = 0;
    for (std::int64_t plan = 0; plan < config_.max_plans; ++plan) {
      const bool last = plan + 1 == config_.max_plans;
      // A way that keeps less distance is better than none.
      RoutePlanner planner = planner_for(0.01 * config_.clearance_cm / (last ? 3.0 : 1.0), avoided);
      MaybeFailure failure = reach(goal, number, &planner);
      if (!failure) failure = stand_and_capture(goal);
      if (!failure) return true;
      drive_.troubles.push_back({goal, robot_.pose(), failure->kind, failure->what});
      const DriveTrouble& trouble = drive_.troubles.back();
      robot_.restore(before);
      if (trouble.lacks_way()) {
        avoided.clear();
        plan = std::max(plan, config_.max_plans - 2);
      } else if ((trouble.at.position - robot_.pose().position).norm() > kAvoid_m &&
                 (trouble.at.position - goals_[goal].position).norm() > kAvoid_m) {
        avoided.push_back(trouble);
      } else {
        ++number;
      }
    }
    return false;
  }

  [[noreturn]] void refuse(std::size_t goal) const {
    throw Error(name_of(goal) + " at " + place_text(goals_[goal]) +
                " cannot be reached:" + what_failed(drive_, goal, is_straight(goal)));
  }

  // Drives there by the plan of this number; then corrects until the place is right.
  MaybeFailure reach(std::size_t goal, int plan, RoutePlanner* planner) {
    const FloorPose& target = goals_[goal];
    if (const MaybeFailure failure = go(target, plan, false, planner)) return failure;
    for (int i = 0; i < kMaxCorrections; ++i) {
      const FloorPose here = robot_.pose();
      const bool placed = (here.position - target.position).norm() <= 0.01 * config_.tolerance_cm;
      const double turn = wrap_angle(target.yaw_rad - here.yaw_rad);
      const bool headed = std::abs(turn) <= deg_to_rad(config_.tolerance_deg);
      if (placed && headed) return std::nullopt;
      ++drive_.corrections;
      if (const MaybeFailure failure = placed ? turn_by(turn, config_, &robot_) : go(target, 0, true, planner))
        return failure;
      robot_.brake(kMaxSettle_s);
    }
    return Failure{Kind::kEndsTooFar, ""};
  }

  MaybeFailure go(const FloorPose& target, int plan, bool correct, RoutePlanner* planner) {
    const std::optional<Route> route = planner->route(robot_.pose(), target, plan, correct);
    if (!route) return Failure{plan > 0 ? Kind::kNoOtherWay : Kind::kNoWay, planner->last_obstacle()};
    return follow(*route, config_, &robot_);
  }

  MaybeFailure stand_and_capture(std::size_t goal) {
    const DrivenRobot::WheelAngles hold = robot_.wheels();
    robot_.stand(config_.settle_s, hold);
    const double deadline = robot_.time_s() + kMaxSettle_s;
    while (robot_.moves_faster_than(1.0)) {
      if (robot_.time_s() > deadline) return Failure{Kind::kDoesNotRest, ""};
      robot_.stand(kControlPeriod_s, hold);
    }
    if (const MaybeFailure failure = robot_.look(0.0)) return failure;
    const Capture capture{robot_.time_s(), robot_.T_scene_robot()};
    const FloorPose here = robot_.pose();
    robot_.stand(kAfterImage_s, hold);
    drive_.reached.push_back(goals_[goal]);
    drive_.captures.push_back(capture);
    drive_.worst_position_m = std::max(drive_.worst_position_m, (here.position - goals_[goal].position).norm());
    drive_.worst_heading_rad =
        std::max(drive_.worst_heading_rad, std::abs(wrap_angle(here.yaw_rad - goals_[goal].yaw_rad)));
    return std::nullopt;
  }

  DrivePhysics& physics_;
  const DriveRequest& request_;
  const DriveConfig& config_;
  std::vector<FloorPose> goals_;
  DrivenRobot robot_;
  Drive drive_;
};

}  // namespace

std::string DriveTrouble::text() const {
  switch (kind) {
    case Kind::kTouches:
      return "touches " + what;
    case Kind::kTippedOver:
      return "tipped over";
    case Kind::kDoesNotTurn:
      return "stuck: does not turn,";
    case Kind::kDoesNotGetOn:
      return "stuck: does not get on,";
    case Kind::kEndsTooFar:
      return "stuck: ends too far from the viewpoint however often it corrects its place,";
    case Kind::kDoesNotRest:
      return "does not come to rest";
    case Kind::kNoWay:
      return "no way: " + what + " is in between,";
    case Kind::kNoOtherWay:
      return "no other way: " + what + " is in between,";
  }
  return "";
}

Drive simulate_drive(DrivePhysics& physics, const DriveRequest& request) {
  if (request.goals.empty()) throw Error("drive: there is no viewpoint to drive to");
  Drive drive = Driver(physics, request).drive();
  drive.T_ground_robot = physics.T_ground_robot();
  return drive;
}

}  // namespace rigproof
